# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Makes of the guides, as they stand in the checkout, what Doxygen wants of them, and of the files that they link to pages.

    prepare.py guides OUTPUT            the *.md as pages: labels at their headings, links as references
    prepare.py header FILE              Doxygen's filter of headers, on stdout: citations become links
    prepare.py finish SITE              after Doxygen: pictures, the interactive figure and the linked files join its pages

A link in a guide is one of the checkout: relative, to a file, a folder or a heading (GitHub's names for them). Here it becomes
one of the site; one that leads nowhere is an error.
"""
import html
import posixpath
import re
import shutil
import sys
import unicodedata
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HEADER = "modules/refract/include/opencv2/refract.hpp"      # its page is the API's
BIBLIOGRAPHY = "modules/refract/doc/refract.bib"
FILES = "files"                                             # where the site has what is no guide
MAIN = "README.md"


def guides():
    """Path in the checkout -> name of the page."""
    pages = {MAIN: "index", "doc/README.md": "guides", "CHANGELOG.md": "changelog", "samples/data/README.md": "sample_data"}
    for path in sorted((ROOT/"doc").glob("*.md")):
        pages.setdefault(f"doc/{path.name}", path.stem)
    return pages


PAGES = guides()
#: Which page stands below which: where a guide is linked first. What is not named here is a page below the list of guides.
PARENTS = {"guides": "index", "changelog": "index", "sample_data": "tour"}


def prose_and_code(text):
    """Lines of prose and lines of code, in turn: (is code, text)."""
    parts, fenced = [], False
    for line in text.splitlines(keepends=True):
        fence = line.lstrip().startswith("```")
        code = fenced or fence or line.startswith("    ")
        fenced ^= fence
        if parts and parts[-1][0] == code:
            parts[-1][1] += line
        else:
            parts.append([code, line])
    return parts


def slug(heading):
    """GitHub's name of a heading."""
    words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
    return re.sub(r"[^\w\- ]", "", words).replace(" ", "-")


def headings(path):
    text = "".join(part for code, part in prose_and_code((ROOT/path).read_text()) if not code)
    return [slug(heading) for heading in re.findall(r"^#+ +(.*)$", text, re.M)]


class Guide:
    def __init__(self, path):
        self.path, self.page = path, PAGES[path]
        self.files = set()          # linked files of the checkout that are no guides

    def text(self):
        # Comments are for test/doc_blocks.py.
        text = re.sub(r"^ *<!--.*?-->\n", "", (ROOT/self.path).read_text(), flags=re.M | re.S)
        parts = [part if code else self.prose(part) for code, part in prose_and_code(text)]
        return "".join(parts)

    def prose(self, text):
        # Doxygen takes a quote within `...` for the end of a quotation.
        text = re.sub(r"`([^`]+)`", lambda code: f"`{code[0]}`" if "'" in code[1] else code[0], text)
        text = re.sub(r"!\[([^\]]*)\]\(([^)\s]+)\)", self.picture, text)
        text = re.sub(r"\[([^\]]*)\]\(([^)\s]+)\)", self.link, text)
        text = re.sub(r"^(#+) +(.*)$", self.heading, text, flags=re.M)
        return re.sub(r"\[\^(\d)\](:?)", self.footnote, text)

    def heading(self, match):
        hashes, title = match.groups()
        label = self.page if hashes == "#" else f"{self.page}_{slug(title)}"
        return f"{hashes} {title}" + ("" if label == "index" else f" {{#{label}}}")

    def footnote(self, match):
        label = f"{self.page}_note{match[1]}"
        return f'<a id="{label}"></a><sup>{match[1]}</sup>' if match[2] else f'<a href="#{label}"><sup>{match[1]}</sup></a>'

    def target(self, link):
        path = posixpath.normpath(posixpath.join(posixpath.dirname(self.path), link)) if link else self.path
        if not (ROOT/path).exists():
            raise SystemExit(f"{self.path}: the link to {link} leads nowhere")
        return path

    def picture(self, match):
        alt, link = match.groups()
        path = posixpath.relpath(self.target(link), "doc")
        return f'<img src="{path}" alt="{html.escape(alt)}">'

    def link(self, match):
        words, link = match.groups()
        if "://" in link:
            return match[0]
        link, _, anchor = link.partition("#")
        path = self.target(link)
        if path == HEADER:
            return f"[{words}](@ref refract)"
        if path in PAGES:
            page = PAGES[path]
            if anchor and anchor not in headings(path):
                raise SystemExit(f"{self.path}: {path} has no heading #{anchor}")
            if anchor:
                return f"[{words}](@ref {page}_{anchor})"
            if PARENTS.get(page, "guides") == self.page and page != "index":
                PARENTS[page] = None        # a page has one place only
                return f'@subpage {page} "{words}"'
            return f"[{words}](@ref {page})" if page != "index" else f"[{words}](index.html)"
        if path == "doc/pane.html":
            return f"[{words}](pane.html)"
        self.files.add(path)
        return f"[{words}]({FILES}/{path}.html)"


ACCENTS = {"'": "\u0301", "`": "\u0300", "^": "\u0302", "~": "\u0303", '"': "\u0308", "v": "\u030c", "c": "\u0327"}


def plain(latex):
    """What a value of the bibliography says."""
    text = re.sub(r"\\([a-zA-Z]|['`^~\"])\s*\{?\\?([a-zA-Z])\}?", lambda m: m[2] + ACCENTS.get(m[1], ""), latex)
    return unicodedata.normalize("NFC", re.sub(r"[{}]", "", text).replace("--", "-").replace("\\&", "&"))


def bibliography():
    """Key -> fields, and how the text names it: Rubin 1985."""
    entries = {}
    for kind, key, body in re.findall(r"@(\w+)\{(\w+),\n(.*?)\n\}", (ROOT/BIBLIOGRAPHY).read_text(), re.S):
        fields = {name.lower(): plain(value) for name, value in re.findall(r"^\s*(\w+)\s*=\s*[{\"](.*)[}\"],?\s*$", body, re.M)}
        names = [author.partition(",")[0] for author in fields.get("author", "").split(" and ") if author]
        who = names[0] + " et al." if len(names) > 2 else " and ".join(names)
        fields["name"] = f"{who} {fields.get('year', '')}".strip() if who else re.sub(r"_|(?=\d{4}$)", " ", key).strip()
        entries[key] = fields
    return entries


def literature():
    """The bibliography as a page."""
    text = "# Literature {#literature}\n\n"
    for key, fields in sorted(bibliography().items()):
        where = [fields[name] for name in ("author", "title", "journal", "booktitle", "institution", "publisher", "volume", "pages",
                                           "year") if name in fields]
        address = f"https://doi.org/{fields['doi']}" if "doi" in fields else fields.get("url", "")
        text += f'<a id="literature_{key}"></a>' + ". ".join(value.rstrip(".") for value in where)
        text += (f" <{address}>" if address else "") + "\n\n"
    return text


def citations(text):
    """@cite KEY -> a link to its place on that page."""
    entries = bibliography()

    def link(match):
        if match[1] not in entries:
            raise SystemExit(f"{BIBLIOGRAPHY} has no {match[1]}")
        return f'<a href="literature.html#literature_{match[1]}">{entries[match[1]]["name"]}</a>'
    return re.sub(r"[@\\]cite +(\w+)", link, text)


def write_guides(output):
    output.mkdir(parents=True, exist_ok=True)
    for path, page in PAGES.items():
        (output/f"{page}.md").write_text(Guide(path).text())
    (output/"literature.md").write_text(literature())


PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title><link rel="stylesheet" href="{up}doxygen.css"><link rel="stylesheet" href="{up}site.css"></head>
<body class="file"><div class="contents"><p><a href="{up}index.html">refract</a></p><h1>{title}</h1>
{content}</div></body></html>
"""


def write_file(site, path):
    """A file or folder of the checkout as a page. Of a folder, its files too."""
    source, page = ROOT/path, site/FILES/f"{path}.html"
    if page.exists():
        return
    page.parent.mkdir(parents=True, exist_ok=True)
    up = "../"*(len(page.relative_to(site).parts) - 1)
    if source.is_dir():
        entries = [e for e in sorted(source.iterdir()) if not e.name.startswith((".", "__"))]
        # A folder with a guide of its own is that guide.
        own = {e: PAGES.get(f"{path}/{e.name}/README.md") for e in entries}
        address = {e: f"{up}{own[e]}.html" if own[e] else f"{source.name}/{e.name}.html" for e in entries}
        items = "".join(f'<li><a href="{address[e]}">{e.name}</a></li>\n' for e in entries)
        page.write_text(PAGE.format(title=path, up=up, content=f"<ul>{items}</ul>"))
        for entry in entries:
            if not own[entry]:
                write_file(site, f"{path}/{entry.name}")
        return
    try:
        content = f'<pre class="fragment">{html.escape(source.read_text())}</pre>'
    except UnicodeDecodeError:
        shutil.copy(source, page.parent/source.name)
        content = f'<p><img src="{source.name}" alt="{path}"></p>'
    page.write_text(PAGE.format(title=path, up=up, content=content))


def finish(site):
    with open(site/"search/search.css", "a") as style:      # the results have a frame of their own
        style.write((ROOT/"doc/site/site.css").read_text())
    for page in site.rglob("*.html"):                       # the name leads home, on telephones too, which show no tree
        text = page.read_text()
        home = "../"*(len(page.relative_to(site).parts) - 1) + "index.html"
        page.write_text(re.sub(r'(<div id="projectname">)\s*(\w+)', rf'\1<a href="{home}">\2</a>', text))
    shutil.copytree(ROOT/"doc/images", site/"images", dirs_exist_ok=True)
    figure = (ROOT/"doc/pane.html").read_text()
    (site/"pane.html").write_text(re.sub(r'href="(\w+)\.md"', r'href="\1.html"', figure))
    for path in PAGES:
        guide = Guide(path)
        guide.text()
        for linked in sorted(guide.files):
            write_file(site, linked)


if __name__ == "__main__":
    what, where = sys.argv[1:]
    if what == "guides":
        write_guides(Path(where))
    elif what == "header":
        sys.stdout.write(citations(Path(where).read_text()))
    else:
        finish(Path(where))
