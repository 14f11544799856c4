"""How a platform's computing and messages grow with the team: all domains, trees, and team sizes to 1024."""
