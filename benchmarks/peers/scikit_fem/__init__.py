"""The strip in scikit-fem and PARDISO: as in its examples, as an expert writes it, and tuned by hand."""
