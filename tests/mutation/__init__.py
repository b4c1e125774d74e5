"""How well the tests hold the code: changed in one place, it should fail one. See docs/testing.md."""
