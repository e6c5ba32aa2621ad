# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Follows every link of a static site that stays within it: href and src of its pages, and what its tree and search lead to.

    links.py SITE       prints what leads nowhere; exit code 1 if anything does
"""
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.links, self.names = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for key, value in attributes:
            if key in ("href", "src") and value is not None:
                self.links.append(value)
            if key == "id" or (key == "name" and tag == "a"):
                self.names.add(value)


def links_of_script(text):
    """What a script of Doxygen's tree and search leads to: strings that are addresses of pages."""
    return re.findall(r"""["']((?:\.\./)*[\w/.-]+\.html(?:#[\w-]*)?)["']""", text)


def main(site):
    pages = {path: Page(path.read_text(errors="replace")) for path in site.rglob("*.html") if "mathjax" not in path.parts}
    links = [(path, link) for path, page in pages.items() for link in page.links]
    for script in [*site.glob("*.js"), *site.glob("search/*.js")]:
        # A script's addresses are those of the page that loads it: pages of the tree stand beside it, the search's frame in search/.
        links += [(script, link) for link in links_of_script(script.read_text())]
    dead, outside = set(), 0
    for path, link in links:
        parts = urlsplit(link)
        if parts.scheme or parts.netloc:
            outside += parts.scheme in ("http", "https")
            if parts.scheme == "file":
                dead.add((path, link, "is a file of one machine"))
            continue
        target = (path.parent/unquote(parts.path)).resolve() if parts.path else path
        if not target.is_relative_to(site):
            dead.add((path, link, "is not in the site"))
        elif not target.is_file():
            dead.add((path, link, "is no file"))
        elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].names:
            dead.add((path, link, "has no such place"))
    for path, link, why in sorted(dead, key=str):
        print(f"{path.relative_to(site)}: {link} {why}")
    print(f"{len(pages)} pages, {len(links)} links, {len(dead)} dead; {outside} lead to other sites and are not followed")
    return 1 if dead else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
