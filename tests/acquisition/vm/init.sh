#!/bin/busybox sh
# SPDX-License-Identifier: MIT
# The emulated machine's first process: loads the virtual cameras, runs the test, tells its status on the second line.
/bin/busybox --install -s /bin
export PATH=/bin
mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t devtmpfs dev /dev
# One card with a webcam and an HDMI input, and an HDMI output to feed it: /dev/video0 captures, /dev/video1 plays.
vivid="n_devs=1 node_types=0x101 num_inputs=2 input_types=0xc num_outputs=1 output_types=1"
while read -r module; do
  parameters=
  [ "$module" = vivid.ko ] && parameters=$vivid
  # shellcheck disable=SC2086 # each parameter is a word
  insmod "/modules/$module" $parameters || echo "cannot load $module"
done </modules/order
eval "$(cat /command)"
status=$?
echo "the machine ran for $(cut -d' ' -f1 /proc/uptime) s"
echo $status >/dev/ttyS1
reboot -f
