# SPDX-License-Identifier: GPL-3.0-or-later
"""Add Hair Guides: the operator, its panel and what it makes."""
