"""The real-kernel rig: a Debian kernel in QEMU with an emulated parallel port. See README.md."""
