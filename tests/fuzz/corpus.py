# SPDX-License-Identifier: GPL-3.0-or-later
"""The kept inputs of the fuzzers: one file for each target, one input a line, two digits a byte.

corpus.py unpack FOLDER    into FOLDER/TARGET, a file for each, as engines read them
corpus.py pack FOLDER      those of FOLDER/TARGET, without earlier comments
corpus.py add TARGET FILE  one more
corpus.py draw FOLDER N    N random ones in FOLDER/TARGET for each target but the readers
"""

import hashlib
import sys
from pathlib import Path
from random import Random

CORPUS = Path(__file__).parent / "corpus"


def kept(target: Path) -> list[bytes]:
    """The inputs of a file of the corpus."""
    lines = target.read_text(encoding="ascii").splitlines()
    return [bytes.fromhex(line) for line in lines if not line.startswith("#")]


def unpack(folder: Path) -> None:
    """A folder for each target, a file for each input, named by its content."""
    for target in sorted(CORPUS.glob("*.hex")):
        place = folder / target.stem
        place.mkdir(parents=True, exist_ok=True)
        for data in kept(target):
            (place / hashlib.sha1(data).hexdigest()).write_bytes(data)


def pack(folder: Path) -> None:
    """The other way; shorter inputs first."""
    for place in sorted(path for path in folder.iterdir() if path.is_dir()):
        inputs = {path.read_bytes() for path in place.iterdir()}
        lines = sorted((data.hex() for data in inputs if data), key=lambda line: (len(line), line))
        (CORPUS / f"{place.name}.hex").write_text("".join(f"{line}\n" for line in lines), "ascii")


def add(target: str, data: bytes) -> None:
    """One more input at the end."""
    with (CORPUS / f"{target}.hex").open("a", encoding="ascii") as file:
        file.write(f"{data.hex()}\n")


def draw(folder: Path, count: int) -> None:
    """Inputs of up to 300 bytes, the same each time, many of small numbers: those are plain."""
    for source in sorted((CORPUS.parent / "targets").glob("*.cpp")):
        random = Random(source.stem)
        place = folder / source.stem
        if source.stem == "readers":
            continue
        place.mkdir(parents=True, exist_ok=True)
        for k in range(count):
            most = random.choice((16, 64, 256))
            data = bytes(random.randrange(most) for _ in range(random.randint(8, 300)))
            (place / f"drawn-{k}").write_bytes(data)


def main(arguments: list[str]) -> None:
    match arguments:
        case ["unpack", folder]:
            unpack(Path(folder))
        case ["pack", folder]:
            pack(Path(folder))
        case ["add", target, path]:
            add(target, Path(path).read_bytes())
        case ["draw", folder, count]:
            draw(Path(folder), int(count))
        case _:
            sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
