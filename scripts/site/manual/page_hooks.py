"""Pages of GitHub's Markdown for MkDocs: formulas as MathML, which browsers draw without a script, anchors of headings and lists as GitHub takes
them, and a search that works on files.

MkDocs calls the functions that begin with on_.
"""

import re
from pathlib import Path

from latex2mathml.converter import convert

CODE = r"(?P<code>^```(?!math).*?^```|^(?: {4,}|\t).*?$|(?P<ticks>`+)(?!`).*?(?<!`)(?P=ticks)(?!`))"
FORMULA = r"^```math\n(?P<block>.*?)^```|\$\$(?P<display>.+?)\$\$|(?<![\w$\\])\$(?=\S)(?P<inline>[^$]*?\S)\$(?![\w$])"
PIECES = re.compile(f"{FORMULA}|{CODE}", re.S | re.M)
STYLE = "<style>math mi{text-transform:none}math mi.one{font-style:italic}</style>"  # where no font has italic Greek letters
TOKEN = re.compile(r"FORMULA(\d+)X")

ITEM = re.compile(r"([-*]|\d+\.) ")
WORKER = Path(__file__).parent / "file_worker.js"

formulas = []  # (LaTeX, whether it has a line of its own); a number each


def token_of(latex, display):
    formulas.append((latex.strip(), display))
    return f"FORMULA{len(formulas) - 1}X"


def replaced(found):
    if found["code"]:
        return found[0]
    if found["inline"]:
        return token_of(found["inline"], False)
    return f"\n\n{token_of(found['block'] or found['display'], True)}\n\n"


def drawn(found):
    latex, display = formulas[int(found[1])]
    return re.sub(r"<mi>(\w|&#x\w+;)</mi>", r'<mi class="one">\1</mi>', convert(latex, display="block" if display else "inline"))


def slug(text, separator):
    """The anchor that GitHub gives to a heading."""
    text = TOKEN.sub(lambda found: formulas[int(found[1])][0], text)
    return re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", separator)


def on_config(config):
    config.mdx_configs["toc"] = {"slugify": slug, "permalink": "#"}
    config.nav = with_option_pages(config.nav, Path(config.docs_dir))
    return config


def with_option_pages(nav, pages):
    """The navigation with the pages of options/ below the table of all options, in the order of its groups."""
    groups = re.findall(r"\((options/\w+\.md)\)", (pages / "options.md").read_text())
    several = {"Options": ["options.md", *groups]}
    for entry in nav:
        for title, parts in entry.items() if isinstance(entry, dict) else ():
            if "options.md" in parts:
                entry[title] = [several if part == "options.md" else part for part in parts]
    return nav


def on_page_markdown(markdown, page, config, files):
    return as_lists(PIECES.sub(replaced, markdown))


def as_lists(text):
    """Lists as Python-Markdown takes them: a blank line before each, and four blanks before what belongs to an item."""
    lines, in_list, in_code, begins_item, before = [], False, False, False, ""
    for line in text.split("\n"):
        in_code ^= line.startswith("```")
        if not in_code and line.strip():
            item = ITEM.match(line)
            if not before.strip():
                begins_item = bool(item)
            if item and before.strip() and not begins_item:
                lines.append("")
                begins_item = True
            if item:
                in_list = True
            elif re.match(r" {2,3}\S", line) and in_list:
                line = "    " + line.lstrip()
            elif not line.startswith(" ") and not before.strip():
                in_list = False
        lines.append(line)
        before = line
    return "\n".join(lines)


def on_post_page(output, page, config):
    """The theme would fetch what starts its search where pages are files."""
    output = output.replace("</head>", STYLE + "</head>")
    return re.sub(r'<script src="https://unpkg\.com/iframe-worker/shim"></script>', f"<script>{WORKER.read_text()}</script>", output)


def on_page_content(html, page, config, files):
    for item in headings(page.toc):
        item.title = TOKEN.sub(lambda found: formulas[int(found[1])][0].replace("\\", ""), item.title)
    return TOKEN.sub(drawn, html)


def headings(items):
    for item in items:
        yield item
        yield from headings(item.children)
