"""Analysis of the same file by a short script with pyuff and NumPy.

Usage: large_analysis.py FILE.uff

Reads one record after the other, averages H1 and coherence, and finds the largest line of the
receptance of each hit between 600 and 1000 Hz. It neither finds nor checks hits, and computes
no damping, harmonics, uncertainties or backbones.
Exit status 77 without pyuff.
"""

import resource
import sys
import time

try:
    import numpy
    import pyuff
except ImportError:
    sys.exit(77)

started = time.perf_counter()
file = pyuff.UFF(sys.argv[1])
functions = [place for place, kind in enumerate(file.get_set_types()) if kind == 58]
averages, force_sum, motion_sum, cross_sum, peaks = 0, 0.0, 0.0, 0.0, []
for of_force, of_motion in zip(functions[0::2], functions[1::2]):
    force, motion = file.read_sets(of_force), file.read_sets(of_motion)
    step = force["abscissa_inc"]
    f = numpy.fft.rfft(force["data"])
    x = numpy.fft.rfft(motion["data"])
    averages += 1
    force_sum = force_sum + abs(f) ** 2
    motion_sum = motion_sum + abs(x) ** 2
    cross_sum = cross_sum + f.conj() * x
    frequency = numpy.fft.rfftfreq(len(force["data"]), step)
    band = (frequency > 600.0) & (frequency < 1000.0)
    receptance = abs(x[band] / f[band]) / (2.0 * numpy.pi * frequency[band]) ** 2
    peaks.append(frequency[band][receptance.argmax()])
h1 = cross_sum / force_sum
coherence = abs(cross_sum) ** 2 / (force_sum * motion_sum)
seconds = time.perf_counter() - started
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
print(f"{averages} hits, {numpy.mean(peaks):.3f} Hz")
print(f"pyuff {pyuff.__version__}, NumPy {numpy.__version__}")
print(f"{seconds:.3f} {memory:.0f}")
