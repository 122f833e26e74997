"""Reads OpenFOAM's dictionaries as far as a mesh needs them: words, lists, and dictionaries in dictionaries."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from collections.abc import Iterator

COMMENT = re.compile(rb"/\*.*?\*/|//[^\n]*", re.DOTALL)
_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[(){};]|[^\s(){};"]+')
_DEEPEST = 50


class Words(tuple[str, ...]):
    """The words of an entry, up to its semicolon."""


Entries = list[tuple[str, "Entries | Words"]]
"""Entries in the file's order: a keyword with a dictionary, or with the words up to the semicolon."""


def read_named(content: bytes) -> Entries:
    """Read a list of named dictionaries, as `boundary` is: a count, and in parentheses names with their entries.

    Raises
    ------
    ValueError
        If a bracket has no partner, or dictionaries are nested more than 50 deep.

    Examples
    --------
    >>> read_named(b"FoamFile { version 2; } 1 ( wall { type patch; extra { a 1; } nFaces 4; } )")
    [('wall', [('type', ('patch',)), ('extra', [('a', ('1',))]), ('nFaces', ('4',))])]
    """
    text = COMMENT.sub(b" ", content).decode("latin-1")
    tokens = iter(_TOKEN.findall(text))
    for token in tokens:
        # the header is a dictionary, too: the list begins with the first parenthesis outside of it
        if token == "{":
            _entries(tokens, "}", 0)
        elif token == "(":
            return _entries(tokens, ")", 0)
    return []


def _entries(tokens: Iterator[str], end: str, depth: int) -> Entries:
    if depth > _DEEPEST:
        raise ValueError(f"dictionaries are nested more than {_DEEPEST} deep")
    found: Entries = []
    for token in tokens:
        if token == end:
            return found
        if token == ";":
            continue
        if token in "(){}":
            raise ValueError(f"a {token!r} stands where a name should")
        following = next(tokens, None)
        if following == "{":
            found.append((token.strip('"'), _entries(tokens, "}", depth + 1)))
        else:
            found.append((token.strip('"'), _words(following, tokens)))
    raise ValueError(f"a {end!r} is missing")


def _words(first: str | None, tokens: Iterator[str]) -> Words:
    """Words up to the semicolon, with the lists and dictionaries among them."""
    words: list[str] = []
    depth = 0
    token = first
    while token is not None:
        if token == ";" and not depth:
            return Words(words)
        depth += (token in "({") - (token in ")}")
        if depth < 0:
            raise ValueError("an entry does not end with a semicolon")
        words.append(token)
        token = next(tokens, None)
    raise ValueError("an entry does not end with a semicolon")
