# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where methods fail: each case made worse step by step, ours beside other programs on the same scenes."""
