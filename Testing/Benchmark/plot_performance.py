# SPDX-License-Identifier: BSD-3-Clause
"""Draws Docs/Images/performance_*.png from the benchmarks' JSON and writes the tables of Docs/Performance.md.

Pictures show processor time of all threads, which other work on the machine disturbs less than the clock.

    pvpython plot_performance.py RESULTS.json DOCS
"""
import collections
import json
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

GROWTH = (("octreeLeaves", "octree"), ("paintFrontOutside", "painting, repair and front"))
BOXES = {0: "1 box", 4: "2$^4$ boxes a side", 5: "2$^5$", 6: "2$^6$"}


class Row:
    """Median of the repetitions of one benchmark."""

    def __init__(self, entry):
        parts = entry["run_name"].split("/")
        self.name = parts[0]
        self.args = [int(p.split(":")[-1]) for p in parts[1:] if p.split(":")[-1].isdigit() and "iterations" not in p]
        scale = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1}[entry["time_unit"]]
        self.seconds = entry["real_time"] * scale
        self.cpu = entry["cpu_time"] * scale
        self.counters = entry


def read(path):
    """Rows by the benchmark's name; a single repetition counts as its own median."""
    with open(path, encoding="utf-8") as file:
        entries = json.load(file)["benchmarks"]
    medians = [e for e in entries if e.get("aggregate_name") == "median"]
    rows = collections.defaultdict(list)
    for entry in medians or [e for e in entries if e["run_type"] == "iteration"]:
        row = Row(entry)
        rows[row.name].append(row)
    return rows


def table(head, lines):
    rows = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(rows + ["| " + " | ".join(line) + " |" for line in lines]) + "\n"


def write_table(page, name, text):
    """Puts the table between the page's marks of that name."""
    begin, end = f"<!-- table {name} -->\n", f"<!-- end {name} -->\n"
    before, rest = page.split(begin)
    return before + begin + text + end + rest.split(end)[1]


def save(figure, folder, name):
    figure.tight_layout()
    figure.savefig(os.path.join(folder, name), dpi=110)
    plt.close(figure)


def draw_growth(rows, folder):
    figure, (time, memory) = plt.subplots(1, 2, figsize=(9, 3.6))
    for name, label in GROWTH:
        leaves = [r.counters["leaves"] for r in rows[name]]
        time.plot(leaves, [1e6 * r.cpu / n for r, n in zip(rows[name], leaves)], "o-", label=label)
    octree = rows["octreeLeaves"]
    leaves = [r.counters["leaves"] for r in octree]
    memory.plot(leaves, [r.counters["bytes_per_leaf"] for r in octree], "o-", label="peak without lists")
    memory.plot(leaves, [r.counters["list_bytes_per_leaf"] for r in octree], "o-", label="triangle lists")
    for axes, caption in ((time, "CPU microseconds a leaf"), (memory, "bytes a leaf")):
        axes.set_xscale("log")
        axes.set_xlabel("leaves")
        axes.set_ylabel(caption)
        axes.set_ylim(bottom=0)
        axes.grid(alpha=0.3)
        axes.legend()
    save(figure, folder, "performance_growth.png")


def draw_figure_3_11(rows, folder):
    figure, axes = plt.subplots(figsize=(6, 4))
    by_boxes = collections.defaultdict(list)
    for row in rows["localisationFigure311"]:
        by_boxes[row.args[1]].append((row.counters["leaves"], row.cpu))
    for bits, points in sorted(by_boxes.items()):
        axes.plot(*zip(*sorted(points)), "o-", label=BOXES[bits])
    axes.set_xlabel("leaves")
    axes.set_ylabel("CPU seconds")
    axes.set_ylim(bottom=0)
    axes.grid(alpha=0.3)
    axes.legend()
    save(figure, folder, "performance_localisation.png")


def draw_closest(rows, folder):
    figure, axes = plt.subplots(figsize=(5, 3.4))
    points = [(r.counters["triangles"], 1e6 * r.cpu) for r in rows["closestPoint"]]
    axes.plot(*zip(*points), "o-")
    axes.set_xscale("log")
    axes.set_xlabel("triangles")
    axes.set_ylabel("CPU microseconds a query")
    axes.set_ylim(bottom=0)
    axes.grid(alpha=0.3)
    save(figure, folder, "performance_closest.png")


def growth_table(rows, name, label):
    first = rows[name][0].cpu / rows[name][0].counters["leaves"]
    lines = []
    for r in rows[name]:
        n = r.counters["leaves"]
        line = [f"{n:,.0f}", f"{r.seconds:.2f}", f"{r.cpu:.2f}", f"{1e6 * r.cpu / n:.2f}", f"{r.cpu / n / first:.2f}"]
        line += [f"{r.counters['bytes_per_leaf']:.0f}"] if name == "octreeLeaves" else []
        lines.append(line)
    head = [f"leaves ({label})", "s", "CPU s", "CPU µs a leaf", "ratio to the first"]
    return table(head + (["bytes a leaf"] if name == "octreeLeaves" else []), lines)


def large_model_table(rows):
    return table(["finest cells", "boxes a side", "leaves", "list entries", "s", "CPU s"],
                 [[f"triangle edge / {r.args[0]}", str(2 ** r.args[1]), f"{r.counters['leaves']:,.0f}",
                   f"{r.counters['list_entries']:,.0f}", f"{r.seconds:.2f}", f"{r.cpu:.2f}"]
                  for r in rows["localisationOfLargeModel"]])


def figure_3_11_table(rows):
    boxes = collections.defaultdict(list)
    for r in rows["localisationFigure311"]:
        boxes[r.args[1]].append(r)
    return table(["boxes a side"] + [f"{r.args[0]:,.0f} leaves" for r in boxes[0]],
                 [[str(2 ** bits)] + [f"{1000 * r.cpu:.0f}" for r in row] for bits, row in sorted(boxes.items())])


def intersections_table(rows):
    return table(["triangles", "segments of the curves", "s", "CPU s"],
                 [[f"{r.counters['triangles']:,.0f}", f"{r.counters['segments']:,.0f}", f"{r.seconds:.3f}",
                   f"{r.cpu:.3f}"] for r in rows["selfIntersectionCurves"]])


def closest_table(rows):
    return table(["triangles", "CPU µs a query"],
                 [[f"{r.counters['triangles']:,.0f}", f"{1e6 * r.cpu:.2f}"] for r in rows["closestPoint"]])


def main():
    results, docs = sys.argv[1:3]
    rows = read(results)
    images = os.path.join(docs, "Images")
    draw_growth(rows, images)
    draw_figure_3_11(rows, images)
    draw_closest(rows, images)
    path = os.path.join(docs, "Performance.md")
    with open(path, encoding="utf-8") as file:
        page = file.read()
    for name, label in GROWTH:
        page = write_table(page, name, growth_table(rows, name, label))
    page = write_table(page, "localisationOfLargeModel", large_model_table(rows))
    page = write_table(page, "localisationFigure311", figure_3_11_table(rows))
    page = write_table(page, "selfIntersectionCurves", intersections_table(rows))
    page = write_table(page, "closestPoint", closest_table(rows))
    with open(path, "w", encoding="utf-8") as file:
        file.write(page)


if __name__ == "__main__":
    main()
