# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The energy balance: against numpy's own solver, and what the solution says of itself."""

import numpy as np
import pytest
from radiosity_bake.core.solve import RESIDUAL, Exchange, gmres, solve_balance

CHANNELS = 3


def system(m: int, seed: int, reflectance: float, missing: int = 0):
    """Random form factors whose rows sum to at most 1 (some have none), reflectances, direct light, areas."""
    rng = np.random.default_rng(seed)
    factor = rng.random((m, m)) * (rng.random((m, m)) < 0.4)
    factor[np.arange(m), (np.arange(m) + 1) % m] = 0.1
    factor /= factor.sum(axis=1, keepdims=True)
    rows = np.sort(rng.permutation(m)[: m - missing])
    dense = np.zeros((m, m))
    dense[rows] = factor[rows].astype(np.float32)
    receiver, source = np.nonzero(dense)
    start = np.flatnonzero(np.diff(receiver, prepend=-1))
    exchange = Exchange(receiver[start], start, source, dense[receiver, source].astype(np.float32))
    rho = reflectance * rng.random((m, CHANNELS)) ** 0.2
    return dense, exchange, rho, rng.random((m, CHANNELS)), rng.random(m) + 0.1


@pytest.mark.parametrize("reflectance", [0.2, 0.5, 0.9, 0.99])
@pytest.mark.parametrize("missing", [0, 7])
def test_the_solution_is_that_of_numpys_solver(reflectance, missing):
    dense, exchange, rho, direct, areas = system(60, 3, reflectance, missing)
    solution = solve_balance(exchange, rho, direct, areas)
    assert solution.converged
    for c in range(CHANNELS):
        matrix = np.eye(60) - rho[:, c : c + 1] * dense
        truth = np.linalg.solve(matrix, rho[:, c] * direct[:, c])
        # A residual r leaves an error of at most r / (1 - rho) in its own norm; areas differ tenfold.
        bound = 10 * RESIDUAL / (1 - reflectance) * np.abs(truth).max()
        np.testing.assert_allclose(solution.reflected[:, c], truth, atol=bound)
        np.testing.assert_allclose(solution.incident[:, c], direct[:, c] + dense @ truth, atol=bound)


@pytest.mark.parametrize("reflectance", [0.5, 0.99])
def test_the_reported_residual_is_the_true_one(reflectance):
    dense, exchange, rho, direct, areas = system(80, 5, reflectance)
    solution = solve_balance(exchange, rho, direct, areas)
    source = rho * direct
    remainder = source - (solution.reflected - rho * (dense @ solution.reflected))
    weight = areas[:, None] / areas.sum()
    true = np.sqrt((weight * remainder**2).sum() / (weight * source**2).sum())
    # Sums in single precision differ from those in double by 1e-7 a term.
    assert solution.residual == pytest.approx(true, rel=0.05, abs=1e-6)
    assert solution.residual <= RESIDUAL


def test_few_iterations_solve_many_bounces():
    _, exchange, rho, direct, areas = system(200, 7, 0.99)
    solution = solve_balance(exchange, rho, direct, areas)
    # Bounce after bounce would take ln 1e-5 / ln 0.99 = 1,146.
    assert solution.converged and solution.iterations < 40


def test_no_direct_light_gives_no_light_and_no_iterations():
    _, exchange, rho, direct, areas = system(20, 1, 0.5)
    solution = solve_balance(exchange, rho, 0 * direct, areas)
    assert solution.converged and solution.iterations == 0 and not solution.reflected.any()


def test_black_surfaces_reflect_nothing_but_receive():
    dense, exchange, rho, direct, areas = system(20, 1, 0.5)
    solution = solve_balance(exchange, 0 * rho, direct, areas)
    assert not solution.reflected.any()
    np.testing.assert_allclose(solution.incident, direct)
    assert dense.any()


def test_reflected_light_is_nowhere_negative():
    _, exchange, rho, direct, areas = system(100, 9, 0.9)
    direct[1:] = 0.0
    solution = solve_balance(exchange, rho, direct, areas)
    assert solution.reflected.min() >= 0 and solution.incident.min() >= 0


def test_channels_do_not_mix():
    _, exchange, rho, direct, areas = system(40, 2, 0.8)
    direct[:, 1:] = 0.0
    solution = solve_balance(exchange, rho, direct, areas)
    assert solution.reflected[:, 0].max() > 0
    assert not solution.reflected[:, 1:].any()


def test_light_that_nothing_absorbs_is_not_called_solved():
    m = 30
    dense, exchange, _, direct, areas = system(m, 4, 1.0)
    del dense
    solution = solve_balance(exchange, np.ones((m, CHANNELS)), direct, areas)
    assert not solution.converged


def test_gmres_solves_what_is_not_symmetric():
    rng = np.random.default_rng(0)
    matrix = np.eye(50) + 0.8 * np.triu(rng.random((50, 50)), 1) / 25
    source = rng.random((50, 1))
    found, _, residual = gmres(lambda x: matrix @ x, source, np.full((50, 1), 1 / 50))
    np.testing.assert_allclose(found, np.linalg.solve(matrix, source), atol=1e-3)
    assert residual <= RESIDUAL


def test_an_exchange_without_rows_gives_nothing():
    nothing = np.zeros(0, dtype=np.int64)
    exchange = Exchange(nothing, nothing, nothing, np.zeros(0, np.float32))
    assert not exchange.apply(np.ones((5, 3))).any()
