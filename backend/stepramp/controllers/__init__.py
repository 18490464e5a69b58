"""Controllers: what each of them can do, the families of them, and a folder for each family."""
