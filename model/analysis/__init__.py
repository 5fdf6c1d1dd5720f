"""What is measured and derived: reference, error bounds, metrics, pruning, reports."""
