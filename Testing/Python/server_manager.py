# SPDX-License-Identifier: BSD-3-Clause
"""Proxies of the server-manager files as ParaView sees them: with what they inherit from a base proxy."""
import copy
import glob
import os
import xml.etree.ElementTree as ElementTree

PROXIES = ("SourceProxy", "WriterProxy")
ONCE = ("OutputPort", "Documentation", "Hints")  # never taken from a base


def definitions(folder):
    """((group, name), stem of the file, element) of everything the folder's files define, bases included."""
    for path in sorted(glob.glob(os.path.join(folder, "*.xml"))):
        for group in ElementTree.parse(path).iter("ProxyGroup"):
            for element in group:
                yield (group.get("name"), element.get("name")), os.path.splitext(os.path.basename(path))[0], element


def proxies(folder):
    """(stem, element) of each filter, reader and writer; what is inherited stands first, as in ParaView."""
    known = {key: element for key, _, element in definitions(folder)}
    for _, stem, element in definitions(folder):
        if element.tag in PROXIES:
            yield stem, merged(element, known)


def merged(element, known):
    base = (element.get("base_proxygroup"), element.get("base_proxyname"))
    if base == (None, None):
        return element
    inherited = merged(known[base], known)  # a base that is not there is an error
    whole = copy.deepcopy(element)
    own = {(child.tag, child.get("name")) for child in element}
    taken = [child for child in inherited if child.tag not in ONCE]
    repeated = sorted(child.get("name") for child in taken if child.get("name") and (child.tag, child.get("name")) in own)
    if repeated:
        raise ValueError(f"{element.get('name')} repeats what it inherits: {repeated}")
    whole[:] = [copy.deepcopy(child) for child in taken] + list(whole)
    return whole


def properties(proxy):
    return [p for p in proxy if p.tag.endswith("VectorProperty")]
