# shellcheck shell=bash
# Minimal Debian systems in a directory. It is sourced after common.sh and needs root.

# make_debian_root DIRECTORY SUITE LOG: makes a minimal system from the package repository of this
# machine, with the settings of apt on this machine. Fails if it cannot.
make_debian_root() {
  local root=$1 suite=$2 log=$3 mirror=''
  (install_packages debootstrap) || return 1
  # shellcheck disable=SC2016  # apt-get expands this
  read -r mirror < <(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Label: Debian') || true
  debootstrap --variant=minbase "$suite" "$root" ${mirror:+"$mirror"} >"$log" 2>&1 || return 1
  cp --no-clobber --recursive /etc/apt/apt.conf.d "$root/etc/apt/"
  # The system is temporary, so that dpkg need not wait for the disk.
  echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/temporary"
  echo "127.0.0.1 localhost $(hostname)" >"$root/etc/hosts"
}

# in_debian_root DIRECTORY [--userspec=USER] COMMAND...: runs a command in the system, without this
# machine's environment except for its proxies.
in_debian_root() {
  local options=() name proxies=()
  if [[ $2 == --userspec=* ]]; then options=("$2"); fi
  for name in {http,https,ftp,no}_proxy {HTTP,HTTPS,FTP,NO}_PROXY; do
    if [[ ${!name-} ]]; then proxies+=("$name=${!name}"); fi
  done
  chroot "${options[@]}" "$1" env --ignore-environment HOME=/root LC_ALL=C.UTF-8 \
    PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive "${proxies[@]}" \
    "${@:2+${#options[@]}}"
}
