"""Which format a file has: its content says so, not its name."""

from stepramp.capture.formats.csv_table import head_of
from stepramp.capture.formats.saleae_csv import is_saleae_csv, read_saleae_csv
from stepramp.capture.formats.sigrok_csv import is_sigrok_csv, read_sigrok_csv
from stepramp.capture.formats.sigrok_session import read_sigrok_session
from stepramp.capture.formats.text import plain
from stepramp.capture.formats.vcd import is_vcd, read_vcd
from stepramp.capture.recording import Recording, refused_file

KNOWN = "digital data as CSV of Saleae Logic 2 or sigrok, as VCD, or as .sr of sigrok"
_PACKED = {
    b"\x1f\x8b": "gzip",
    b"BZh": "bzip2",
    b"\xfd7zXZ": "xz",
    b"7z\xbc\xaf": "7-Zip",
    b"Rar!": "RAR",
    b"\x28\xb5\x2f\xfd": "Zstandard",
}
"""What packed a file, by how that begins."""
LOOKED_AT_BYTES = 4096
"""So much tells whether a file is text."""


def read_file(content: bytes) -> Recording:
    """Return what a file has captured.

    Raises Rejected for one that is empty, broken, too large, or of no known format.
    """
    if not content or content.isspace():
        raise refused_file("empty", KNOWN)
    if content.startswith(b"PK\x03\x04"):
        return read_sigrok_session(content)
    if content.startswith(b"<SALEAE>"):
        raise refused_file("binary data of Saleae Logic 2", "the same, exported as CSV")
    packer = next((name for beginning, name in _PACKED.items() if content.startswith(beginning)), None)
    if packer is not None:
        raise refused_file(f"packed with {packer}", f"the same unpacked: {KNOWN}")
    text = plain(content)
    if 0 in text[:LOOKED_AT_BYTES]:
        raise refused_file("a binary file of no known kind", KNOWN)
    if is_vcd(text[:200]):
        return read_vcd(text)
    head = head_of(text)
    if is_sigrok_csv(head):
        return read_sigrok_csv(text)
    if is_saleae_csv(head):
        return read_saleae_csv(text)
    raise refused_file(f"text that begins with {text[:60].decode('utf-8', 'replace')!r}", KNOWN)
