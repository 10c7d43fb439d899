"""In scikit-fem and PARDISO: as its examples show it, as an expert writes it, or tuned by hand."""
