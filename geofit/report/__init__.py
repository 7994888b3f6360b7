"""The results of a run as plain data, and what people read of them: JSON, CSV, HTML and pictures.

Nothing here reads a file, fits or opens a window. Import the module that is needed: pictures cost matplotlib,
scenes cost pyvista.
"""
