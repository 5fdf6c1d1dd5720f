"""Studies: corner cases, worst cases, methods, true surfaces."""
