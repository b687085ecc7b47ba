"""Waveform files (VCD) read, measured and drawn, whoever wrote them. Knows nothing of machines."""
