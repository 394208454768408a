left = 310.0
load shared.'dual-fig10/dual-fig10.gp'
