# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How well and how fast we bake: scenes, a converged reference, probes, and the peers. Nothing here is shipped."""

from tools.package import load_package

load_package()
