# SPDX-License-Identifier: Apache-2.0
"""Writes a C program with a given code size. It calls many functions with branches in turn, so that all code is hot.

Every function has conditions on bits of its argument, a short loop, loads and stores, like the code of a real program. No two
functions are equal. Equal sizes give equal programs.
"""

import random

FUNCTION_BYTES = 193  # measured size of one function and its call, compiled with -O1 for rv32imc


def expression(chance):
    constant = chance.randrange(1, 2000)
    return chance.choice((f"x += {constant}", f"x ^= x >> {chance.randrange(1, 9)}", f"x -= y + {constant}",
                          f"y += x << {chance.randrange(1, 5)}", f"x ^= data[y & 63]", f"data[x & 63] += y",
                          f"y = (y ^ {constant}) - x"))


def condition(chance):
    return chance.choice((f"x & {1 << chance.randrange(0, 8)}", f"(x ^ y) & {1 << chance.randrange(0, 6)}",
                          f"(int)x < (int)y", f"(y & 31) > {chance.randrange(3, 29)}"))


def function(number, chance):
    lines = [f"static __attribute__((noinline)) unsigned f{number}(unsigned x, unsigned y) {{"]
    for _ in range(4):
        lines.append(f"  if ({condition(chance)}) {{ {expression(chance)}; {expression(chance)}; }}"
                     f" else {{ {expression(chance)}; }}")
    lines.append(f"  for (unsigned i = x & 3; i; --i) {{ {expression(chance)}; }}")
    lines.append("  return x + y;\n}")
    return "\n".join(lines)


def source(code_bytes):
    """Returns the C source of `unsigned turn(unsigned)`, which calls each of several functions once. The functions together have
    about `code_bytes` bytes of code."""
    chance = random.Random(20)
    count = max(1, round(code_bytes / FUNCTION_BYTES))
    functions = "\n".join(function(number, chance) for number in range(count))
    calls = [f"  x = f{number}(x, {chance.randrange(1, 1 << 12)});" for number in range(count)]
    # Divides the calls into groups, because a function with thousands of calls takes too long to compile.
    groups = [calls[first:first + 50] for first in range(0, count, 50)]
    parts = "\n".join(f"static __attribute__((noinline)) unsigned part{i}(unsigned x) {{\n" + "\n".join(group) +
                      "\n  return x;\n}" for i, group in enumerate(groups))
    turn = "\n".join(f"  x = part{i}(x);" for i in range(len(groups)))
    return f"static unsigned data[64];\n{functions}\n{parts}\nunsigned turn(unsigned x) {{\n{turn}\n  return x;\n}}\n"
