"""Clouds of points that are longer than the memory, and many tasks on several processors or machines."""
