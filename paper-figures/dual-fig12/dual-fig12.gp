load shared.'dual-fig10/dual-fig10.gp'
