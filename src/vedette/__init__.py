"""Vedette: a team of platforms gathers information together, with no central computer."""
