#!/usr/bin/env bash
# System packages that the tests and the windows need on Linux: the one list of them.
#
#   tools/system_packages.sh           install what is missing (Debian and Ubuntu, as root)
#   tools/system_packages.sh missing   name what is missing on one line, install nothing
set -euo pipefail
cd "$(dirname "$0")/.."

[ "$(uname -s)" = Linux ] || exit 0

# Libraries that the wheels load but do not carry: OpenCASCADE and VTK (the first two lines), Qt (the others).
declare -A package=(
    [libGL.so.1]=libgl1 [libEGL.so.1]=libegl1 [libX11.so.6]=libx11-6 [libexpat.so.1]=libexpat1
    [libgomp.so.1]=libgomp1 [libXrender.so.1]=libxrender1
    [libglib-2.0.so.0]=libglib2.0-0 [libdbus-1.so.3]=libdbus-1-3 [libfontconfig.so.1]=libfontconfig1
    [libfreetype.so.6]=libfreetype6 [libxkbcommon.so.0]=libxkbcommon0 [libxkbcommon-x11.so.0]=libxkbcommon-x11-0
    [libxcb-cursor.so.0]=libxcb-cursor0 [libxcb-icccm.so.4]=libxcb-icccm4 [libxcb-image.so.0]=libxcb-image0
    [libxcb-keysyms.so.1]=libxcb-keysyms1 [libxcb-render-util.so.0]=libxcb-render-util0
)
missing=()
known=$(PATH="$PATH:/sbin:/usr/sbin" ldconfig -p)
for library in "${!package[@]}"; do
    [[ "$known" == *"$library"* ]] || missing+=("${package[$library]}")
done
# A screen for the tests of the windows (tests/gui/conftest.py starts it), and a font with Chinese characters.
command -v Xvfb >/dev/null || missing+=(xvfb)
if ! command -v fc-list >/dev/null || [ -z "$(fc-list :lang=zh-cn)" ]; then
    missing+=(fontconfig fonts-noto-cjk)
fi
# A software renderer: libEGL alone draws nothing where there is no graphics card.
compgen -G '/usr/lib*/dri/*_dri.so' >/dev/null || compgen -G '/usr/lib/*/dri/*_dri.so' >/dev/null ||
    missing+=(libgl1-mesa-dri libegl-mesa0)
python=$(make -s python 2>/dev/null || true)
if [ -n "$python" ] && ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then
    missing+=(python3-venv)
fi

[ ${#missing[@]} -gt 0 ] || exit 0
if [ "${1:-}" = missing ]; then
    echo "Missing system packages: ${missing[*]}. Install them with: make system-packages (as root)"
elif [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    export DEBIAN_FRONTEND=noninteractive
    apt-get update -qq
    apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
else
    echo "Missing system packages: ${missing[*]}. Install them (Debian and Ubuntu: sudo apt-get install ${missing[*]})." >&2
    exit 1
fi
