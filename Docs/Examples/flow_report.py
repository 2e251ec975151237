# SPDX-License-Identifier: BSD-3-Clause
"""The figures of the flows that junction_flow.sh and motorbike_potential.sh compute, from what OpenFOAM has written:

    flow_report.py junction CASE     iterations, residuals, flows, pressure drop, y+
    flow_report.py motorbike CASE    residual, flows

Exits 0 only when simpleFoam's residuals are as small as its case asks for, and the flows in and out agree within 0.1%."""
import os
import re
import sys

DENSITY = 1.2  # of air, kg/m3; simpleFoam's pressure is divided by it
OUTLETS = ("outlet1", "outlet2", "outlet3")
LARGEST_IMBALANCE = 1e-3


def read(*path):
    with open(os.path.join(*path), encoding="utf-8") as file:
        return file.read()


def last_row(case, function, name="surfaceFieldValue"):
    """The words of the last line that a function object has written."""
    return read(case, "postProcessing", function, "0", f"{name}.dat").strip().splitlines()[-1].split()


def initial_residuals(log):
    """Of the last iteration, by field; the largest of a vector's components, the first of several solutions for p."""
    last = log[log.rindex("\nTime = "):]
    residuals = {}
    for name, value in re.findall(r"Solving for (\w+), Initial residual = ([^,]+)", last):
        if name.startswith("U"):
            residuals["U"] = max(residuals.get("U", 0.0), float(value))
        else:
            residuals.setdefault(name, float(value))
    return residuals


def processor_seconds(log):
    return float(re.findall(r"ExecutionTime = (\S+) s", log)[-1])


def unbalanced(imbalance):
    """A sentence when it is too much, or None."""
    print(f"in - out, relative   {imbalance:.1e}")
    if abs(imbalance) > LARGEST_IMBALANCE:
        return f"What comes in and what goes out differ by {100 * abs(imbalance):.2f}%."
    return None


def junction(case):
    """Prints the figures; a sentence on what is wrong, or None."""
    log = read(case, "log.simpleFoam")
    converged = re.search(r"SIMPLE solution converged in (\d+) iterations", log)
    flow_in = -float(last_row(case, "flow_inlet")[1])
    flows_out = [float(last_row(case, f"flow_{outlet}")[1]) for outlet in OUTLETS]
    residuals = ", ".join(f"{name} {value:.1e}" for name, value in initial_residuals(log).items())
    shares = ", ".join(f"{name} {100 * flow / flow_in:.2f}%" for name, flow in zip(OUTLETS, flows_out))
    low, high, mean = map(float, last_row(case, "yPlus", "yPlus")[2:])
    print(f"iterations           {converged.group(1) if converged else 'not converged'}")
    print(f"processor seconds    {processor_seconds(log):.0f}")
    print(f"initial residuals    {residuals}")
    print(f"flow in              {flow_in:.4e} m3/s")
    print(f"flow out             {shares}")
    print(f"pressure drop        {DENSITY * float(last_row(case, 'pressure_inlet')[1]):.4f} Pa")
    print(f"y+ on the wall       {low:.2g} to {high:.2g}, mean {mean:.2g}")
    wrong = unbalanced((flow_in - sum(flows_out)) / flow_in)
    return wrong if converged else "The flow has not converged; what to change is in system/fvSolution and fvSchemes."


def motorbike(case):
    log, flows = read(case, "log.potentialFoam"), read(case, "log.postProcess")
    side_in, side_out = (float(re.search(rf"sum\({side}\) of phi = (\S+)", flows).group(1)) for side in ("xmin", "xmax"))
    residual = float(re.findall(r"Solving for Phi, Initial residual = ([^,]+)", log)[-1])
    print(f"processor seconds    {processor_seconds(log):.0f}")
    print(f"last residual        {residual:.1e}")
    print(f"flow in              {-side_in:.6g} m3/s")
    return unbalanced((side_in + side_out) / side_in)


CASES = {"junction": junction, "motorbike": motorbike}

if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in CASES:
        sys.exit(__doc__)
    try:
        sys.exit(CASES[sys.argv[1]](sys.argv[2]))
    except FileNotFoundError as error:
        sys.exit(f"There is no file {error.filename}; the solver has not come so far.")
