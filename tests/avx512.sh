#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a test program on a processor with AVX-512, which few machines have and QEMU does not know: Bochs emulates a whole
# computer, which boots Linux with the program from a CD. What takes 3 seconds takes it about 10 minutes. On Debian 12.
#   tests/avx512.sh PROGRAM REPORT [FILE]...     REPORT: where its JUnit report goes; FILE: what else it reads
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

[ $# -ge 2 ] || fail 'tests/avx512.sh needs a program and a report; see its head'
program=$(realpath -- "$1") report=$(realpath -m -- "$2")
shift 2
work=$root/build/avx512
kernel=linux-image-cloud-amd64
need_packages bochs bochs-term bochsbios busybox-static cpio genisoimage isolinux syslinux-common vgabios

# The package is unpacked, not installed: nothing of this system's own start changes.
fetch_kernel() {
  local name
  name=$(apt-cache depends "$kernel" | awk '/Depends: linux-image/ {print $2; exit}')
  mkdir -p "$work/kernel" && cd "$work/kernel" && apt-get -q download "$name" && dpkg -x "$name"_*.deb .
}

# Before anything else the system runs a program that is not there yet: this one.
write_init() {
  cat <<'END'
#!/bin/busybox sh
/bin/busybox mount -t proc proc /proc
/bin/busybox mount -t devtmpfs dev /dev
/bin/busybox grep -q avx512f /proc/cpuinfo && /bin/busybox echo 'a processor with AVX-512'
/program --gtest_brief=1 --gtest_output=xml:/report.xml
/bin/busybox cat /report.xml
/bin/busybox sleep 20
/bin/busybox poweroff -f
END
}

# A file system with the program, its libraries and the files that it reads.
build_system() {
  local system=$work/system file
  rm -rf "$system" && mkdir -p "$system"/{bin,dev,proc} &&
    cp /bin/busybox "$system/bin" && cp "$program" "$system/program" || return
  for file in $(ldd "$program" | grep -o '/[^ ]*') "$@"; do
    mkdir -p "$system/$(dirname "$file")" && cp -L "$file" "$system/$file" || return
  done
  write_init >"$system/init" && chmod +x "$system/init"
  (cd "$system" && find . | cpio -o -H newc --quiet) | gzip -1 >"$work/disc/isolinux/initrd"
}

# Without two instructions that save registers: Linux counts their bytes otherwise than Bochs, and then trusts neither.
build_disc() {
  local boot=$work/disc/isolinux
  rm -rf "$work/disc" && mkdir -p "$boot" && build_system "$@" &&
    cp "$work"/kernel/boot/vmlinuz-* "$boot/vmlinuz" &&
    cp /usr/lib/ISOLINUX/isolinux.bin /usr/lib/syslinux/modules/bios/ldlinux.c32 "$boot" &&
    printf '%s\n' 'DEFAULT linux' 'LABEL linux' 'KERNEL vmlinuz' \
      'APPEND initrd=initrd console=ttyS0,115200 quiet clearcpuid=321,323 nopku mitigations=off tsc=unstable lpj=1000000' \
      >"$boot/isolinux.cfg" &&
    genisoimage -quiet -o "$work/boot.iso" -b isolinux/isolinux.bin -c isolinux/boot.cat -no-emul-boot \
      -boot-load-size 4 -boot-info-table -J -R "$work/disc"
}

write_computer() {
  cat <<END
display_library: term
cpu: model=corei7_skylake_x, count=1, ips=50000000
memory: guest=1024, host=1024
romimage: file=/usr/share/bochs/BIOS-bochs-latest
vgaromimage: file=/usr/share/bochs/VGABIOS-lgpl-latest
ata0: enabled=1, ioaddr1=0x1f0, ioaddr2=0x3f0, irq=14
ata0-master: type=cdrom, path=$work/boot.iso, status=inserted
boot: cdrom
com1: enabled=1, mode=file, dev=$work/console.txt
log: $work/bochs.log
END
}

# It opens a terminal of its own to draw on, says which, and stops once nobody reads that; and it waits for a command of its
# debugger. Power off ends it with an error.
run_computer() {
  local screen
  rm -f "$work/console.txt"
  write_computer >"$work/bochsrc" && echo c >"$work/commands"
  bochs-bin -q -f "$work/bochsrc" -rc "$work/commands" </dev/null 2>&1 |
    while IFS= read -r line; do
      screen=$(sed -n 's/.*connected to screen "\(.*\)".*/\1/p' <<<"$line")
      [ -z "$screen" ] || cat "$screen" >/dev/null 2>&1 &
    done || true
  tr -d '\r' <"$work/console.txt" | tee "$work/said.txt"
  grep -q 'a processor with AVX-512' "$work/said.txt" &&
    sed -n '/^<?xml/,/^<\/testsuites>/p' "$work/said.txt" >"$report" && grep -q '^</testsuites>' "$report"
}

[ -d "$work/kernel/boot" ] || stage 'kernel' fetch_kernel
stage 'disc' build_disc "$@"
stage 'computer with AVX-512' run_computer
