"""Band matrices and their factors: Cholesky, LDL^T, LU, bordered; no elements and no load steps."""
