#!/usr/bin/env bash
# Installs the package into a fresh environment, as anybody would, and tests it. PyVista is used if CELLFAN_PYVISTA is set.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/../../target}" PYTHONDONTWRITEBYTECODE=1 PIP_DISABLE_PIP_VERSION_CHECK=1
out="$(mktemp -d)"
trap 'rm -rf "$out"' EXIT
python3 -m venv "$out"
"$out/bin/pip" install --quiet ".[test${CELLFAN_PYVISTA:+,pyvista}]"
"$out/bin/python" -m pytest -q -rs -p no:cacheprovider
