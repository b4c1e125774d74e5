"""The lookup as its node group computes it, against exact geometry: families of cases, a bound, what guards are for."""
