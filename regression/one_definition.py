#!/usr/bin/env python3
"""Checks that no two sources define the same name in a namespace: a type, a function of the same parameters, an inline constant.

    one_definition.py              the tree; one line for each name that several files define
    one_definition.py --self-test  sources made up for the test: faults are found, and sources without one have none

No compiler sees two such sources together. The linker keeps one of two inline functions of a name, so that a type can get the
constructor of another one, unless an optimiser makes both part of their callers. Names of one source alone belong into a
namespace without a name.
"""
import pathlib
import re
import sys

FOLDERS = ("kokkos_kernels", "lib", "app", "regression/unit")  # linked with one another
NO_CODE = re.compile(r'R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|//[^\n]*|/\*(?:.|\n)*?\*/')
TYPE = re.compile(r"\b(?:struct|class|union|enum(?: class| struct)?) (?:alignas ?\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\) ?)?"
                  r"(?:\[\[[^]]*\]\] ?)?(\w+ ?(?:<.*>)?)(?: final)? ?(?::(?!:).*)?$")
CONSTANT = re.compile(r"\binline (?:constexpr|const|thread_local|static)? ?.*?\b(\w+) ?(?:\[[^]]*\] ?)?(?:=|$)")
QUALIFIERS = re.compile(r"(?:\) ?(?:const|noexcept|override|->.*|requires.*) ?)$")


def code_of(text):
    """A source without comments, texts and lines of the preprocessor."""
    text = NO_CODE.sub(lambda m: '""' if m[0][0] in "R\"" else "0" if m[0][0] == "'" else " ", text)
    return re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", "", text, flags=re.M)


def parts_of(text, mark=","):
    """Parts of the text between the marks that are in no brackets."""
    parts, depth = [""], 0
    for letter in text:
        depth += {"(": 1, "<": 1, "[": 1, "{": 1, ")": -1, ">": -1, "]": -1, "}": -1}.get(letter, 0)
        if letter == mark and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return parts


def type_of(parameter):
    """The type of a parameter, without its name and default."""
    parameter = parts_of(parameter, "=")[0].strip()
    words = re.sub(r"\b(?:const|typename|volatile)\b|\[[^]]*\]", " ", parameter).split()
    has_name = len(words) > 1 or re.search(r"[&*>] ?\w+$", parameter)
    return re.sub(r"\s*\b\w+( ?\[[^]]*\])?$", r"\1", parameter) if has_name else parameter


def function_of(head):
    """Name and types of the parameters of the function that a head before a brace begins; None where it begins another thing."""
    head = re.sub(r"\[\[[^]]*\]\]|__attribute__ ?\(\(.*?\)\)", "", head)
    head = re.sub(r"(?<=\)) ?:(?!:).*", "", head)  # what a constructor initialises
    while QUALIFIERS.search(head):
        head = QUALIFIERS.sub(")", head).strip()
    if not head.endswith(")"):
        return None
    depth, at = 1, len(head) - 1
    while at > 0 and depth:
        at -= 1
        depth += {")": 1, "(": -1}.get(head[at], 0)
    name = re.search(r"(\boperator ?\S+|[\w:~]+) ?$", head[:at])
    before = head[:name.start()].strip() if name else ""
    if not before or "::" in name[1] or name[1] == "main" or re.search(r"\bstatic\b", before):
        return None
    template, rest = "", before
    while rest.startswith("template"):
        rest = rest[len("template"):].strip()
        size = next(k for k in range(1, len(rest) + 1) if rest.count("<", 0, k) == rest.count(">", 0, k))
        template, rest = template + rest[:size].replace("class", "typename"), rest[size:].strip()
    return f"{name[1]}{template}({', '.join(type_of(parameter) for parameter in parts_of(head[at + 1:-1]))})"


def names_of(text):
    """The names that a source defines in namespaces that have one."""
    names, open_braces, begin = set(), [], 0
    code = code_of(text)
    for mark in re.finditer(r"[{};]", code):
        head, begin = " ".join(code[begin:mark.start()].split()), mark.end()
        in_namespace = None not in open_braces
        space = re.search(r"\bnamespace ?([\w:]*)$", head) if mark[0] == "{" else None
        if in_namespace and "" not in open_braces and not space and mark[0] != "}":
            kind = TYPE.search(head) if mark[0] == "{" else None
            found = kind[1] if kind else function_of(head) if mark[0] == "{" else None
            if not found and not head.endswith(")") and re.search(r"\binline\b", parts_of(head, "(")[0]):
                constant = CONSTANT.search(head)
                found = constant[1] if constant else None
            if found:
                names.add("::".join([*open_braces, found.replace(" ", "") if kind else found]))
        if mark[0] == "{":
            open_braces.append(space[1] if in_namespace and space else None)
        elif mark[0] == "}" and open_braces:
            open_braces.pop()
    return names


def faults_of(sources):
    """One line for each name that several of the sources {path: text} define."""
    where = {}
    for path, text in sources.items():
        for name in names_of(text):
            where.setdefault(name, []).append(path)
    return [f"{name}: defined in {' and '.join(sorted(paths))}" for name, paths in sorted(where.items()) if len(paths) > 1]


def self_test():
    one = """#pragma once
        namespace mpm {
        struct Clock { double start = 0; };
        template <class T> struct Of { T x; };
        inline constexpr int k_most = 3;
        enum class Wall { fixed };
        template <class T> KOKKOS_INLINE_FUNCTION T twice(const T& a, int n = 1) { return a; }
        namespace { struct Own {}; int own(int a) { return a; } }
        static int alone() { return 0; }
        }"""
    inside = {"struct Clock { long step; };": "mpm::Clock", "class Clock final : public Base { };": "mpm::Clock",
              "template <class A> class Of { };": "mpm::Of", "enum Wall : int { k_fixed };": "mpm::Wall",
              "inline constexpr double k_most = 4;": "mpm::k_most", "inline constexpr int k_most{4};": "mpm::k_most",
              "template <typename T> T twice(const T& b, int) { return b + b; }": "mpm::twice<typename T>(const T&, int)",
              "struct alignas(group<T, 2>) Clock { };": "mpm::Clock"}
    for text, name in inside.items():
        found = faults_of({"one.hpp": one, "other.hpp": f"namespace mpm {{ {text} }}"})
        assert len(found) == 1 and name in found[0] and "one.hpp and other.hpp" in found[0], (text, found)
    for text in ("struct Clock;", "// struct Clock { };", 'inline const char* text = "struct Clock { };";',
                 "struct Run { struct Clock { }; };", "namespace { struct Clock { }; }", "namespace impl { struct Clock { }; }",
                 "template <> struct Of<int> { };",
                 "#define CLOCK \\\n struct Clock { };\n",
                 "double twice(double a, int n) { return a; }", "T Clock::now() { return 0; }",
                 "Clock::Clock(int a) : twice(a) { }",
                 "static int alone() { return 1; }", "namespace { int own(int a) { return 1; } struct Own {}; }",
                 "void f() { struct Clock { }; }", "template <class T> T twice(const T& a, int n);"):
        found = faults_of({"one.hpp": one, "other.hpp": f"namespace mpm {{\n{text} }}"})
        assert not found, (text, found)


if __name__ == "__main__":
    if sys.argv[1:] == ["--self-test"]:
        sys.exit(self_test())
    tree = pathlib.Path(__file__).resolve().parents[1]
    sources = {str(path.relative_to(tree)): path.read_text()
               for folder in FOLDERS for path in sorted((tree / folder).rglob("*.[hc]pp"))}
    faults = faults_of(sources)
    print("\n".join(faults) or f"{len(sources)} sources define each name once")
    sys.exit(bool(faults))
