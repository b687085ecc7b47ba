#!/bin/busybox sh
# The guest's first process: drivers, the host's root, the job, and off.
#
#   /        this file system, in memory          /root   the host's /, read-only
#   /out     the results folder, for a moment; then under its own path inside /root
#
# So every path of the host is the same path in the guest, wherever the checkout lies, and nothing
# of it is hidden; only the results folder can be written.
B=/bin/busybox
$B mount -t devtmpfs none /dev
$B mount -t proc none /proc
$B mount -t sysfs none /sys
$B mount -t securityfs none /sys/kernel/security
while read -r module; do $B insmod "/mods/$module.ko" || echo "insmod $module failed"; done </mods/order

options=trans=virtio,version=9p2000.L,msize=262144
$B mount -t 9p -o "ro,$options,cache=loose" host /root
$B mount -t 9p -o "rw,$options" results /out
read -r folder </out/place
for name in dev proc sys; do $B mount --move "/$name" "/root/$name"; done
$B mount --move /out "/root$folder"
$B ip link set lo up

export HOME="$folder" TMPDIR="$folder" PYTHONDONTWRITEBYTECODE=1
export PATH=/usr/local/bin:/usr/bin:/bin:/usr/local/sbin:/usr/sbin:/sbin
$B chroot /root /bin/sh "$folder/job.sh" >"/root$folder/job.log" 2>&1
echo $? >"/root$folder/exit-code"
$B sync
$B umount "/root$folder"
$B poweroff -f
