#!/usr/bin/env python3
"""Prints what the structure of the sources costs: lines, classes, and what a change rebuilds.

    structure.py [TREE]     TREE: a source tree, also of another version (default: this one)

A kernel source is a .cpp file of kokkos_kernels/. The files that a new law, vector of the particles and kind of side modify are held by
the test regression.added_law.
"""
import pathlib
import re
import sys

ROOTS = ("kokkos_kernels", "lib/include", "lib", "kokkos_kernels/base")
DATA = {"sides": "sides.hpp", "water": "water.hpp", "loads on surfaces": "surface_loads.hpp", "rigid bodies": "rigid_pose.hpp"}
CLASSES = ("Core", "ContactCore", "State", "TypedStepper", "Body")


def sources_in(tree):
    """Text of each source under its path, without comments."""
    return {str(path.relative_to(tree)): re.sub(r"//.*", "", path.read_text())
            for top in ("kokkos_kernels", "lib", "app") for path in sorted((tree / top).rglob("*.[hc]pp"))}


def includes_of(path, texts):
    places = [str(pathlib.PurePath(path).parent), *ROOTS]
    for name in re.findall(r'^\s*#\s*include\s*"([^"]+)"', texts[path], re.M):
        found = next((f"{place}/{name}" for place in places if f"{place}/{name}" in texts), None)
        if found:
            yield found


def reached_from(path, texts):
    """All files that a source includes, through others too."""
    reached, ahead = set(), [path]
    while ahead:
        at = ahead.pop()
        if at not in reached:
            reached.add(at)
            ahead += includes_of(at, texts)
    return reached


def body_of(text, name):
    """Text between the braces of a struct or class; None where it is not defined there."""
    start = re.search(rf"\b(?:struct|class) (?:\w+::)?{name}\b[^;{{]*\{{", text)
    if start is None:
        return None
    depth, at = 1, start.end()
    while depth > 0:
        depth += {"{": 1, "}": -1}.get(text[at], 0)
        at += 1
    return text[start.end():at - 1]


def statements_of(body):
    """Declarations of a struct's own, without what stands in inner braces, brackets of templates and parameters."""
    while re.search(r"\{[^{}]*\}", body):
        body = re.sub(r"\{[^{}]*\}", ";", body)
    body = re.sub(r"\b(public|private|protected):|^\s*#.*$", "", body, flags=re.M)
    while re.search(r"<[^<>;]*>", body):
        body = re.sub(r"<[^<>;]*>", "", body)
    return [" ".join(s.split()) for s in body.split(";") if s.strip()]


def counts_of(body):
    """Members and methods."""
    members = methods = 0
    for statement in statements_of(body):
        if re.match(r"(using|friend|static constexpr|enum|struct|class|template$|requires|static_assert)\b", statement):
            continue
        if "(" in statement.split("=")[0]:
            methods += 1
        else:
            members += len(statement.split("=")[0].split(",")) if "=" not in statement else statement.count(",") + 1
    return members, methods


def main():
    tree = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
    texts = sources_in(tree)
    kernels = [path for path in texts if path.startswith("kokkos_kernels/") and path.endswith(".cpp")]
    print(f"{'lines of kokkos_kernels, lib and app':58}{sum(len(path.read_text().splitlines()) for top in ('kokkos_kernels', 'lib', 'app') for path in (tree / top).rglob('*.[hc]pp')):8}")
    print(f"{'lines of regression/reliability':58}{sum(len(path.read_text(errors='replace').splitlines()) for path in (tree / 'regression/reliability').rglob('*') if path.is_file() and path.suffix in ('', '.py')):8}")
    print(f"{'files at the root of lib':58}{len([path for path in (tree / 'lib').iterdir() if path.suffix in ('.cpp', '.hpp')]):8}")
    for name in CLASSES + tuple(sorted({found for path, text in texts.items() if path.startswith("lib/run/") and path.endswith(".hpp")
                                        for found in re.findall(r"^(?:class|struct) (\w+)", text, re.M)})):
        bodies = [body for text in texts.values() for body in [body_of(text, name)] if body is not None]
        if bodies:
            members, methods = counts_of(max(bodies, key=len))
            print(f"{'members and methods of ' + name:58}{members:8}{methods:5}")
    for what, header in DATA.items():
        hit = [path for path in kernels if any(reached.endswith("/" + header) for reached in reached_from(path, texts))]
        print(f"{'kernel sources that a change of the data of ' + what + ' rebuilds':58}{len(hit):8} of {len(kernels)}")
    print(f"{'parameter lists that take a whole State':58}{sum(len(re.findall(r'State<[^<>]*>& ', text)) for text in texts.values()):8}")


if __name__ == "__main__":
    main()
