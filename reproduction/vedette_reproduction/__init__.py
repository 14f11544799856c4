"""The paper's figures and claims, each made anew by a small computation."""
