"""Real sets, their scores on points left out, and the page that shows them: used by ``benchmarks/real.py``."""
