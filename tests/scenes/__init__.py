# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes whose answer is known exactly (`exact`), and slow independent form factors (`oracle`)."""
