load shared.'three-particle-gaps/three-particle-gaps.gp'
