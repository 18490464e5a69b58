"""Names and comments in exported files: whatever a design is called, they are harmless where they stand."""

import re

MOST_CHARACTERS = 40
NAME_RULE = (
    f"a letter, then letters, digits and underscores, up to {MOST_CHARACTERS} characters in all and no keyword of C; "
    "or null"
)
FALLBACK = "ramp"
C_WORDS = frozenset((
    "auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else", "enum", "extern",
    "float", "for", "goto", "if", "inline", "int", "long", "register", "restrict", "return", "short", "signed",
    "sizeof", "static", "struct", "switch", "typedef", "union", "unsigned", "void", "volatile", "while", "asm",
    "class", "delete", "namespace", "new", "operator", "private", "protected", "public", "template", "this", "throw",
    "try", "using", "virtual", "bool", "true", "false",
))  # fmt: skip
"""Keywords of C99, and of C++, in which Arduino sketches are written."""


def is_identifier(text: str) -> bool:
    """Return whether a text may begin the names of a C file."""
    return bool(re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", text)) and len(text) <= MOST_CHARACTERS and text not in C_WORDS


def identifier_of(name: str) -> str:
    """Return a design's name as what the names of a C file begin with.

    >>> identifier_of("Lead-screw stage"), identifier_of("2 axes"), identifier_of("日本")
    ('lead_screw_stage', 'ramp_2_axes', 'ramp')
    """
    words = "_".join(re.findall("[a-z0-9]+", name.lower()))
    if not words or words[0].isdigit() or words in C_WORDS:
        words = f"{FALLBACK}_{words}"
    return words[:MOST_CHARACTERS].strip("_")


def comment_text(text: str) -> str:
    """Return a text so that it can stand in a C comment: on one line, and without what would end or disturb it.

    >>> comment_text('a */ #error /* b')
    'a * / #error / * b'
    """
    line = "".join(character if character.isprintable() else " " for character in text).replace("\\", "/")
    for pair in ("*/", "/*", "//", "??"):
        while pair in line:
            line = line.replace(pair, f"{pair[0]} {pair[1]}")
    return line
