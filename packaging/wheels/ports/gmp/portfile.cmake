# SPDX-License-Identifier: GPL-3.0-or-later
set(VCPKG_POLICY_EMPTY_PACKAGE enabled)
