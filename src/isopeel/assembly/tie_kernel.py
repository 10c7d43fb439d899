"""Compiled: coefficients and forces of functions that follow others, and the tangent without them."""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.spaces import HELD
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled
from isopeel.matrix.band import entry_place


class Followers(NamedTuple):
    """Functions whose coefficients are sums of others' coefficients, for compiled code."""

    functions: IntArray  # (n,) those that follow
    starts: IntArray  # (n + 1,) where the leaders of each begin
    leaders: IntArray  # functions that do not follow
    shares: FloatArray  # of the coefficients of the leaders


@compiled
def follow(followers: Followers, u: FloatArray) -> None:
    """Set the coefficients (size, 2) of the functions that follow."""
    for k in range(len(followers.functions)):
        for i in range(2):
            total = 0.0
            for n in range(followers.starts[k], followers.starts[k + 1]):
                total += followers.shares[n] * u[followers.leaders[n], i]
            u[followers.functions[k], i] = total


@compiled
def lead(followers: Followers, forces: FloatArray) -> None:
    """Move forces (size, 2) on the functions that follow to those which they follow."""
    for k in range(len(followers.functions)):
        f = followers.functions[k]
        for i in range(2):
            for n in range(followers.starts[k], followers.starts[k + 1]):
                forces[followers.leaders[n], i] += followers.shares[n] * forces[f, i]
            forces[f, i] = 0.0


@compiled
def condense_tangent(
    band: FloatArray,
    diagonal: int,
    half_bandwidth: int,
    unknowns: IntArray,
    followers: Followers,
    mixed: IntArray,
) -> None:
    """Replace the tangent K in a band (see `BandMatrix`) by C^T K C, without functions that follow several.

    Row and column of their own unknowns keep a diagonal entry alone. One unknown is eliminated after another:
    x_s = sum_k w_k x_k changes K_kj by w_k K_sj, and K_kl by w_k w_l K_ss. The band must have room for that
    (see `TiedFunctions.coupled`).
    """
    stride, is_symmetric = band.shape[1] - 1, diagonal == 0
    flat, last = band.reshape(-1), len(band) - 2
    row, column = np.empty(2 * half_bandwidth + 1), np.empty(2 * half_bandwidth + 1)
    for n in mixed:
        start, end = followers.starts[n], followers.starts[n + 1]
        for i in range(2):
            s = unknowns[followers.functions[n], i]
            low, high = max(s - half_bandwidth, 0), min(s + half_bandwidth, last)
            for j in range(low, high + 1):
                by_row, by_column = (s, j), (j, s)
                if is_symmetric:
                    by_row = by_column = max(s, j), min(s, j)
                one = entry_place(stride, diagonal, by_row[0], by_row[1])
                other = entry_place(stride, diagonal, by_column[0], by_column[1])
                row[j - low], column[j - low] = flat[one], flat[other]
                flat[one] = flat[other] = 0.0
            own = row[s - low]
            row[s - low] = column[s - low] = 0.0
            # of the size of its neighbours; without any stiffness, of any
            flat[entry_place(stride, diagonal, s, s)] = abs(own) if own != 0.0 else 1.0
            for k in range(start, end):
                m, share = unknowns[followers.leaders[k], i], followers.shares[k]
                if m == HELD:
                    continue
                for j in range(low, high + 1):
                    if row[j - low] == 0.0 and column[j - low] == 0.0:
                        continue
                    if is_symmetric:
                        changed = share * row[j - low] * (2.0 if m == j else 1.0)
                        flat[entry_place(stride, diagonal, max(m, j), min(m, j))] += changed
                    else:
                        flat[entry_place(stride, diagonal, m, j)] += share * row[j - low]
                        flat[entry_place(stride, diagonal, j, m)] += share * column[j - low]
                for h in range(start, end):
                    j = unknowns[followers.leaders[h], i]
                    if j != HELD and (m >= j or not is_symmetric):
                        changed = share * followers.shares[h] * own
                        flat[entry_place(stride, diagonal, m, j)] += changed
