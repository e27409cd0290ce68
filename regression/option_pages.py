"""Pages of docs/options, one a group of options, from what `mpm -schema` prints and the decks of the repository: regression/options_doc.py."""

import pathlib
import re

import mpm_regression  # noqa: F401  puts soil_mpm on the path
from soil_mpm.deck import Deck
from soil_mpm.problems import WrongDeck
from soil_mpm.schema import Schema

ROOT = pathlib.Path(__file__).resolve().parents[1]
FOLDER = ROOT / "docs" / "options"
DECKS = ("inputs/*.opts", "inputs/element/*.opts", "regression/answers/*.opts", "regression/cases/*/case.opts")
SIDE = re.compile(r"mesh_[xyz](min|max)")
MOST_RELATED = 12
# Values of options that no deck gives.
VALUES = {"NAME_cohesion": "5e3", "NAME_friction_deg": "32", "NAME_dilation_deg": "5", "NAME_yield_stress": "250e6", "NAME_shear_modulus": "5e6",
          "NAME_preconsolidation": "80e3", "NAME_shear_limit": "10e3", "NAME_axis": "0,1", "NAME_stop_deg": "-30,30", "NAME_moment_point": "0,2",
          "NAME_centre_of_mass": "0,1", "NAME_moment": "1e3", "NAME_parts": "sheet,stem", "NAME_field": "strength.h5", "NAME_library": "out/law.so",
          "NAME_properties": "1e7,0.3,20e3", "NAME_states": "3", "NAME_state_start": "0,0,0", "NAME_thread_safe": "on", "NAME_young_gradient": "500e3",
          "NAME_young_datum": "10", "NAME_strength_factor": "1.3", "NAME_tension": "0", "NAME_cohesion_gradient": "1e3", "NAME_cohesion_datum": "10",
          "NAME_angle_deg": "30", "NAME_tip_angle_deg": "60", "NAME_file_body": "soil", "NAME_hardening_modulus": "1e9", "NAME_pressure_offset": "1e3",
          "NAME_water_level": "4", "NAME_restitution": "0.5", "NAME_contact_gap_exponent": "4", "NAME_pore_stiffness": "1e8", "NAME_exponent": "0.5",
          "NAME_bodies": "soil", "strength_factor": "1.3", "water_tension": "0", "flip_fraction": "0.99", "xpic_order": "3", "stray_particles": "remove",
          "output_dir": "out/try", "output_compression": "4", "restart": "latest", "restart_change": "gravity", "wall_time_limit": "3600",
          "device_memory_limit": "16", "dry_run": "on", "element_path": "path.csv", "element_parts": "80", "element_height": "2",
          "raster_threshold_speed": "0.1", "raster_bodies": "slide", "partition": "metis", "p2g_bins": "nodes"}
# Pages that explain a group, by the beginning of its name.
READ = {"Run": ("running.md",), "Single": ("elements.md",), "Particle-to-node": ("performance.md",), "Several ranks": ("scaling.md",),
        "Names": ("first_job.md",), "Mesh": ("first_job.md", "method.md"), "Sides": ("boundaries.md",), "Physics": ("method.md", "flow.md"),
        "Time": ("method.md",), "Output": ("results.md",), "Rasters": ("probes.md",), "Material": ("soils.md",), "Each material": ("soils.md", "water.md"),
        "Each body": ("ground.md",), "Each rigid": ("bodies.md",), "Each joint": ("bodies.md",), "Each load": ("loads.md",), "Each probe": ("probes.md",),
        "Each stage": ("stages.md",), "Each contact pair": ("contact.md",), "Contact": ("contact.md",), "Each water": ("water.md",)}
CHANGES = {"restart": "at a restart", "restart_change": "at a restart, by `-restart_change`", "stage": "at a [stage](../stages.md)"}


def file_of(group):
    """Name of the page of a group."""
    words = re.sub(r"\(.*?\)|[:,].*", "", group).replace("Material NAME of model ", "law ").replace("NAME", "").replace("STAGE", "")
    return re.sub(r"[^a-z0-9]+", "_", words.lower()).strip("_") + ".md"


def examples(schema_text, program):
    """{(group, name in the table): (line of a deck, the deck)}, of the first deck that gives the option. program: whose schema it is."""
    schema, found = Schema.of_text(schema_text), {}
    for pattern in DECKS:
        for path in sorted(ROOT.glob(pattern)):
            try:
                deck = Deck.read(path, program)
            except WrongDeck:  # it includes another deck by a path from elsewhere
                continue
            names = deck.names()
            table = schema.table(names)
            given = deck.given()
            for key, value in given.items():
                for option in table.get(schema.present_name(key), []):
                    if has_place(option, given):
                        found.setdefault((option.group, table_name(schema, option)), (f"-{key} {value}".rstrip(), path.relative_to(ROOT).as_posix()))
    return found


def has_place(option, given):
    """Whether an option of a material belongs to the law that a deck gives."""
    return all(given.get(each.option.lower(), each.words[0]) in each.words for each in option.where if each.option.endswith("_model") and each.words)


def table_name(schema, option):
    """The name in the table of an option of a deck: NAME_su for clay_su."""
    mine = [each for each in schema.options if each.group == option.group]
    same = next((each.name for each in mine if each.name == option.name), None)
    return same or max((each.name for each in mine if each.owned and option.name.endswith("_" + each.key)), key=len)


def merged(options):
    """Options of a group as lists: those of the six sides that say the same are one list."""
    lists = {}
    for option in options:
        key = tuple(SIDE.sub("mesh_SIDE", str(option[part])) for part in ("name", "meaning", "takes", "default"))
        lists.setdefault(key, []).append(option)
    return list(lists.values())


def anchor_of(name):
    return re.sub(r"[^\w\- ]", "", f"-{name}".lower())


def text_of(condition, link):
    words = condition["is"]
    either = " or ".join(f"`{word}`" for word in words)
    return f"{link(condition['option'])} " + (f"is {either}" if words else "is given" if condition["given"] else "is not given")


class Pages:
    """The pages of all groups, of a program and of what its -schema prints."""

    def __init__(self, schema_text, schema, program):
        self.options, self.examples = schema["options"], examples(schema_text, program)
        self.groups = list(dict.fromkeys(option["group"] for option in self.options))
        self.place = {}
        for option in self.options:
            self.place.setdefault(option["name"], []).append(option["group"])
        self.heads = {option["name"]: several[0]["name"] for group in self.groups for several in merged(self.of(group)) for option in several}

    def of(self, group):
        return [option for option in self.options if option["group"] == group]

    def link(self, name, group):
        """A link to the section of an option, on the page of a group: its own where that has it."""
        groups = self.place.get(name)
        if not groups:
            return f"`-{name}`"
        page = "" if group in groups else file_of(groups[0])
        return f"[`-{name}`]({page}#{anchor_of(self.heads[name])})"

    def related(self, option, group):
        """Names of options that its conditions or words name, and of those that hold only where this one has some value."""
        own = [each["option"] for each in option.get("where", [])]
        said = re.findall(r"-((?:NAME_)?[a-z]\w+)", " ".join([option["meaning"], option["takes"], *option.get("restrictions", [])]))
        words = set(re.findall(r"[a-z]\w+", option["meaning"]))
        said += [each["name"] for each in self.of(group) if "_" in (key := each["name"].partition("NAME_")[2]) and key in words]
        back = [each["name"] for each in self.options if any(where["option"] == option["name"] for where in each.get("where", []))
                and (group in self.place[each["name"]] or not option["name"].startswith(("NAME_", "STAGE_")))]
        heads = [self.heads[name] for name in own + said + back if name in self.place]
        return [name for name in dict.fromkeys(heads) if name != self.heads[option["name"]]][:MOST_RELATED]

    def example(self, option, group):
        line, deck = self.examples.get((group, option["name"]), (None, None))
        return f"    {line}          # {deck}\n" if line else ""

    def made_example(self, option):
        """A line for an option that no deck gives: a value of its table."""
        name, choices = option["name"], option.get("choices", [])
        other = next((word for word in choices if word != option["default"]), None)
        value = VALUES.get(name) or other or ("motion.csv" if name.endswith("_table") else option["default"])
        if value is None or " " in value:
            raise ValueError(f"-{name}: no deck gives it, and VALUES has no value")
        return f"    -{name} {value}\n"

    def section(self, several, group):
        option = several[0]
        link = lambda name: self.link(name, group)
        lines = [f"## -{option['name']}\n", option["meaning"][:1].upper() + option["meaning"][1:] + ".\n"]
        if len(several) > 1:
            lines.append("The same for " + ", ".join(f"`-{each['name']}`" for each in several[1:]) + ".\n")
        where = [text_of(each, link) for each in option.get("where", [])]
        default = option["default"]
        required = "wherever it has a place" if where else "always"
        rows = [("takes", option["takes"]), ("unit", "none" if option.get("unit") == "-" else option.get("unit", "")),
                ("default", f"required {required}" if option["required"] else "none" if default is None else f"`{default}`" if " " not in default else default),
                ("only where", " and ".join(where)), ("restrictions", "; ".join(option.get("restrictions", []))),
                ("may change", " and ".join(CHANGES[each] for each in option.get("changes", [])))]
        lines.append("| | |\n| --- | --- |\n" + "".join(f"| {name} | {text} |\n" for name, text in rows if text))
        lines.append(next((text for each in several if (text := self.example(each, group))), "") or self.made_example(option))
        related = self.related(option, group)
        lines += ["Related: " + ", ".join(link(name) for name in related) + ".\n"] * bool(related)
        return "\n".join(lines)

    def page(self, group):
        read = next((pages for begin, pages in READ.items() if group.startswith(begin)), ())
        head = [f"# Options: {group}\n",
                "Made from `mpm -schema` by `regression/options_doc.py`. [All options in one table](../options.md)."
                + (" Explained in " + ", ".join(f"[{name}](../{name})" for name in read) + "." if read else "") + "\n"]
        return "\n".join(head + [self.section(several, group) for several in merged(self.of(group))])

    def all(self):
        """{name of the file: its text}"""
        return {file_of(group): self.page(group) for group in self.groups}
