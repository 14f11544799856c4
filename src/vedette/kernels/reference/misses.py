"""What the kernels of sparse log-misses compute, by plain loops."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from itertools import groupby

import numpy as np

from vedette.kernels.misses import SparseMisses

LONGEST = 12  # bits of a symbol's word
ONLY = LONGEST + 1  # in a table: the only symbol of its code, which takes no bits
SIZES, MISSES = 33, 256  # symbols: bits that a number can have, and log-misses
Words = dict[int, str]  # of each symbol


def pack_misses(impact: SparseMisses, cells: int, layers: int) -> bytes:
    """Return an impact's bytes: its runs under three prefix codes."""
    runs = list(runs_of(impact, cells, layers))
    bits = number_bits(len(runs), 32)
    if runs:
        codes = [
            words_of(code_lengths(Counter(symbols))) for symbols in zip(*map(symbols_of, runs), strict=True)
        ]
        bits += "".join(table_bits(words) for words in codes)
        for run in runs:
            gap, more, miss = (words[symbol] for words, symbol in zip(codes, symbols_of(run), strict=True))
            bits += gap + below_highest(run[0]) + more + below_highest(run[1]) + miss
    return int(bits[::-1], 2).to_bytes(-(-len(bits) // 8), "little")


def runs_of(impact: SparseMisses, cells: int, layers: int) -> Iterable[tuple[int, int, int]]:
    """Yield gap before, places beside the first, and log-miss of each run of places in a row of a layer."""
    entries = zip(impact.keys.tolist(), impact.misses.tolist(), strict=True)
    places = sorted((key % layers * cells + key // layers, miss) for key, miss in entries)
    end = 0
    together = groupby(
        enumerate(places), lambda each: (each[1][0] - each[0], each[1][0] // cells, each[1][1])
    )
    for (_, _, miss), group in together:
        run = [place for _, (place, _) in group]
        yield run[0] - end, len(run) - 1, miss
        end = run[-1] + 1


def symbols_of(run: tuple[int, int, int]) -> tuple[int, int, int]:
    """Return what stands for a run in the three codes."""
    return run[0].bit_length(), run[1].bit_length(), run[2]


def number_bits(number: int, bits: int) -> str:
    """Return so many bits of a number, the lowest first."""
    return f"{number:0{bits}b}"[::-1] if bits else ""


def below_highest(number: int) -> str:
    """Return the bits of a number below its highest."""
    size = max(number.bit_length() - 1, 0)
    return number_bits(number - (1 << size), size) if size else ""


def code_lengths(counts: Counter[int]) -> dict[int, int]:
    """Return how many bits each symbol takes: Huffman's, over flatter counts until none takes too many."""
    while True:
        lengths = depths(counts)
        if max(lengths.values()) <= LONGEST:
            return lengths
        counts = Counter({symbol: count - count // 2 for symbol, count in counts.items()})


def depths(counts: Counter[int]) -> dict[int, int]:
    """Join the two lightest parts again and again; of equals symbols come first, then those joined before."""
    parts = [(count, 0, symbol, [symbol]) for symbol, count in counts.items()]
    lengths = dict.fromkeys(counts, 0)
    joined = 0
    while len(parts) > 1:
        parts.sort(key=lambda part: part[:3])
        (a, _, _, left), (b, _, _, right) = parts[:2]
        for symbol in left + right:
            lengths[symbol] += 1
        parts = [*parts[2:], (a + b, 1, joined, left + right)]
        joined += 1
    return lengths


def words_of(lengths: dict[int, int]) -> Words:
    """Return the bits of each symbol: short words first, equally long ones by symbol, counted up."""
    words, word, before = Words(), 0, 0
    for symbol, length in sorted(lengths.items(), key=lambda each: (each[1], each[0])):
        word = word + 1 << length - before if words else 0
        words[symbol], before = f"{word:0{length}b}" if length else "", length
    return words


def table_bits(words: Words) -> str:
    """Return a code's table: the length of each symbol's word, or 0 and how many that do not occur."""
    bits, at = "", 0
    for symbol, word in sorted(words.items()):
        while at < symbol:
            told = min(symbol - at, 16)
            bits, at = bits + number_bits(0, 4) + number_bits(told - 1, 4), at + told
        bits, at = bits + number_bits(len(word) or ONLY, 4), at + 1
    return bits


def unpack_misses(data: bytes, cells: int, layers: int, most: int) -> SparseMisses:
    """Return the impact of such bytes.

    Raises:
        ValueError: they are no impact over these cells and layers.
    """
    take = reader(data)
    entries, place = list[tuple[int, int]](), 0
    try:
        runs = number(take(32))
        codes = [read_table(symbols, take) for symbols in (SIZES, SIZES, MISSES)] if runs else []
        for _ in range(runs):
            gap, more = (read_number(words, take) for words in codes[:2])
            miss = read_symbol(codes[2], take)
            place += gap
            if len(entries) + more + 1 > most:
                raise ValueError("impact is cut short or too large")
            if place + more >= cells * layers or miss == 0:
                raise ValueError("impact has a cell outside the map or an empty entry")
            for at in range(place, place + more + 1):
                entries.append((at % cells * layers + at // cells, miss))
            place += more + 1
        if "1" in (rest := take(None)) or len(rest) > 7:
            raise EOFError
    except EOFError:
        raise ValueError("impact is cut short or too large") from None
    entries.sort()
    keys, misses = zip(*entries, strict=True) if entries else ((), ())
    return SparseMisses(np.array(keys, np.uint32), np.array(misses, np.uint8))


def reader(data: bytes) -> Callable[[int | None], str]:
    """Return a function that takes so many bits, or all that are left; EOFError: there are fewer."""
    bits, at = "".join(number_bits(byte, 8) for byte in data), 0

    def take(count: int | None) -> str:
        nonlocal at
        end = len(bits) if count is None else at + count
        if end > len(bits):
            raise EOFError
        taken, at = bits[at:end], end
        return taken

    return take


def number(bits: str) -> int:
    """Return the number of some bits, the lowest first."""
    return int(bits[::-1], 2) if bits else 0


def read_table(symbols: int, take: Callable[[int | None], str]) -> dict[str, int]:
    """Return the symbol of each word of a code.

    Raises:
        ValueError: it is no code's.
    """
    lengths, at, room = dict[int, int](), 0, 1 << LONGEST
    while room:
        length = number(take(4))
        if length == 0:
            at += number(take(4)) + 1
        elif length == ONLY and room == 1 << LONGEST and at < symbols:
            return {"": at}
        elif length < ONLY and at < symbols and 1 << LONGEST - length <= room:
            lengths[at] = length
            room -= 1 << LONGEST - length
            at += 1
        else:
            raise ValueError("impact has a table of no code")
        if at > symbols:
            raise ValueError("impact has a table of no code")
    return {word: symbol for symbol, word in words_of(lengths).items()}


def read_symbol(words: dict[str, int], take: Callable[[int | None], str]) -> int:
    """Return the symbol whose word is ahead."""
    word = ""
    while word not in words:
        word += take(1)
    return words[word]


def read_number(words: dict[str, int], take: Callable[[int | None], str]) -> int:
    """Return a number told by its size and the bits below its highest."""
    size = read_symbol(words, take)
    return number(take(size - 1)) + (1 << size - 1) if size else 0
