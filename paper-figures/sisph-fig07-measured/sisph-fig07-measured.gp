load shared.'difference.gp'
