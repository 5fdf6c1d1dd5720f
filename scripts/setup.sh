#!/bin/sh
# Makes .venv from requirements.txt; does nothing where that is done already. Exits with 2, after a
# first line that says what to do, if a system program is missing or the installation fails.
set -u
cd "$(dirname "$0")/.." || exit 2
lock=requirements.txt
stamp=.venv/installed # written last: whatever interrupts an installation, it is made anew

missing= packages=
need() { # need WHAT PACKAGE
  missing="${missing:+$missing, }$1"
  packages="$packages $2"
}

for program in make g++ perl git; do
  command -v $program >/dev/null 2>&1 || need $program $program
done

# An installation is good for one lock and one interpreter.
wanted="$(python3 -c 'import sys; print(sys.version, sys.base_prefix)' 2>/dev/null)
$(cksum <"$lock")"
[ -z "$missing" ] && [ "$(cat $stamp 2>/dev/null)" = "$wanted" ] &&
  .venv/bin/python -c '' 2>/dev/null && exit 0

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

echo "Installing the pinned packages of $lock into .venv (once) ..." >&2
mkdir -p build && rm -rf .venv || exit 2
log=build/setup.log
if python3 -m venv .venv >$log 2>&1 &&
  .venv/bin/python -m pip install --quiet --disable-pip-version-check --no-input \
    --require-hashes --requirement "$lock" >>$log 2>&1; then
  printf '%s\n' "$wanted" >$stamp
else
  echo "Phong75: the installation failed: $(grep -i error $log | tail -n 1) (all of it: $log)" >&2
  exit 2
fi
