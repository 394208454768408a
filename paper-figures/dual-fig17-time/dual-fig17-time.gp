load shared.'patch-iterations/patch-iterations.gp'
