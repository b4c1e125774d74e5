"""What an artist sees: operators, menus, panels."""
