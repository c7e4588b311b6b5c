"""Converts the atoms of mmCIF files into records of the PDB format, for PDB2PQR.

Items: "Protein Data Bank exchange dictionary (PDBx/mmCIF)", category atom_site. Syntax: S. R. Hall,
F. H. Allen, I. D. Brown, Acta Cryst. A47 (1991) 655-685, doi:10.1107/S010876739101067X.
"""

import itertools
import re
import string

from eses_tools.common import Failed

# A value in quotes, which end at a quote before a blank; the rest of a comment; or a bare value.
TOKEN = re.compile(r"""'(.*?)'(?=\s|$)|"(.*?)"(?=\s|$)|(\#.*)|(\S+)""")

CHAINS = string.ascii_uppercase + string.ascii_lowercase + string.digits
NO_VALUE = (".", "?")
ADVICE = "; read the file directly with --radii protor"
MISFIT = "not fit the PDB format, which PDB2PQR reads" + ADVICE


def tokens(lines):
    """Yields the words of the file, each with whether it is bare: a tag, keyword or value."""
    lines = iter(lines)
    for line in lines:
        if line.startswith(";"):  # text of several lines, which ends at the next semicolon
            text = [line[1:], *itertools.takewhile(lambda line: not line.startswith(";"), lines)]
            yield "".join(text), False
            continue
        for single, double, comment, bare in TOKEN.findall(line):
            if not comment:
                yield (bare, True) if bare else (single or double, False)


def is_control(word, is_bare):
    return is_bare and (word[0] == "_" or re.match(r"(loop_$|data_|save_|stop_$)", word, re.I))


def atom_sites(lines):
    """Yields a dictionary from the name of an item to its text for each atom. Items without a value
    are left out."""
    stream = tokens(lines)
    for word, is_bare in stream:
        if is_bare and word.lower() == "loop_":
            tags = []
            for word, is_bare in stream:
                if not is_bare or not word.startswith("_"):
                    break
                tags.append(word.lower())
            if tags and tags[0].startswith("_atom_site."):
                break
    else:
        return
    names = [tag.partition(".")[2] for tag in tags]
    values = itertools.takewhile(lambda token: not is_control(*token),
                                 itertools.chain([(word, is_bare)], stream))
    while row := list(itertools.islice(values, len(names))):
        yield {name: word for name, (word, is_bare) in zip(names, row)
               if not (is_bare and word in NO_VALUE)}


def fitted(text, width, what):
    """Returns the text right-aligned. Throws Failed if it is too long for the PDB format."""
    if len(text) > width:
        raise Failed(f"{what} {text} does {MISFIT}")
    return text.rjust(width)


def record(site, chain):
    """Returns the line of an atom. Throws Failed if an item is missing or does not fit."""
    def item(*names, default=None):
        value = next((site[name] for name in names if name in site), default)
        if value is None:
            raise Failed(f"an atom has no _atom_site.{names[-1]}")
        return value

    def number(name, width, decimals, default=None):
        text = item(name, default=default)
        try:
            return fitted(f"{float(text):.{decimals}f}", width, name)
        except ValueError:
            raise Failed(f"expected a number as _atom_site.{name}, found {text[:40]!a}") from None

    element = item("type_symbol", default="")
    name = item("auth_atom_id", "label_atom_id")
    # Symbols of elements with one letter stand in the second column of the name.
    name = fitted((name if len(element) > 1 or len(name) > 3 else " " + name).ljust(4), 4,
                  "the name of the atom")
    return (item("group_pdb", default="ATOM").ljust(6) + "    0 " + name
            + fitted(item("label_alt_id", default=""), 1, "the alternate location")
            + fitted(item("auth_comp_id", "label_comp_id"), 3, "the name of the residue")
            + " " + chain + fitted(item("auth_seq_id", "label_seq_id"), 4, "the residue number")
            + fitted(item("pdbx_pdb_ins_code", default=""), 1, "the insertion code") + "   "
            + "".join(number("cartn_" + axis, 8, 3) for axis in "xyz")
            + number("occupancy", 6, 2, "1") + number("b_iso_or_equiv", 6, 2, "0")
            + " " * 10 + fitted(element, 2, "the element") + "\n")


def chain_of(site):
    return site.get("auth_asym_id") or site.get("label_asym_id", " ")


def chain_letters(names):
    """Returns a letter for each name of a chain: the name itself, or a free one if it is longer."""
    free = (letter for letter in CHAINS if letter not in names)
    letters = {name: name if len(name) == 1 else next(free, None) for name in names}
    if None in letters.values():
        raise Failed(f"{len(names)} chains do {MISFIT}")
    return letters


def to_pdb(lines):
    """Yields the ATOM records of the first model, and the ends of its chains."""
    sites = [site for site in atom_sites(lines) if site.get("group_pdb", "ATOM").upper() == "ATOM"]
    models = [site.get("pdbx_pdb_model_num") for site in sites]
    sites = [site for site, model in zip(sites, models) if model == models[0]]
    letters = chain_letters(dict.fromkeys(map(chain_of, sites)))
    for name, chain in itertools.groupby(sites, chain_of):
        for site in chain:
            yield record(site, letters[name])
        yield "TER\n"
