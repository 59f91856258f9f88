"""First 64-bit outputs of ChaCha8 keyed by four SplitMix64 outputs: the truth of tests/rng.rs.

Run: python3 chacha8.py
Layout of the state: RFC 8439 2.3 with a 64-bit counter (words 12, 13) and a 64-bit stream (words 14, 15).
"""
import struct

M32, M64 = 0xFFFFFFFF, 0xFFFFFFFFFFFFFFFF


def split_mix(state):
    state = (state + 0x9E3779B97F4A7C15) & M64
    z = state
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & M64
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & M64
    return state, z ^ (z >> 31)


def quarter(x, a, b, c, d):
    def add_turn(i, j, k, n):
        x[i] = (x[i] + x[j]) & M32
        t = x[k] ^ x[i]
        x[k] = ((t << n) | (t >> (32 - n))) & M32

    add_turn(a, b, d, 16)
    add_turn(c, d, b, 12)
    add_turn(a, b, d, 8)
    add_turn(c, d, b, 7)


def block(key, counter, stream, rounds=8):
    start = [0x61707865, 0x3320646E, 0x79622D32, 0x6B206574]
    start += list(struct.unpack("<8I", key))
    start += [counter & M32, counter >> 32, stream & M32, stream >> 32]
    x = list(start)
    for _ in range(rounds // 2):
        for q in [(0, 4, 8, 12), (1, 5, 9, 13), (2, 6, 10, 14), (3, 7, 11, 15)]:
            quarter(x, *q)
        for q in [(0, 5, 10, 15), (1, 6, 11, 12), (2, 7, 8, 13), (3, 4, 9, 14)]:
            quarter(x, *q)
    return [(a + b) & M32 for a, b in zip(x, start)]


for seed, stream in [(0, 0), (1, 0), (1, 7), (M64, 0x5CE00001)]:
    state, words = seed, []
    for _ in range(4):
        state, z = split_mix(state)
        words.append(z)
    w = block(struct.pack("<4Q", *words), 0, stream)
    outputs = [w[2 * i] | (w[2 * i + 1] << 32) for i in range(3)]
    print(f"({seed:#x}, {stream:#x}, [" + ", ".join(f"{o >> 11:#x}" for o in outputs) + "]),")
