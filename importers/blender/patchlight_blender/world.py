"""The world: a colour or an image as it is, any other node tree baked to an equirectangular image."""


class World:
    def __init__(self, scene, folder, name, options, baker, report):
        self.environment = {}

    def suns(self):
        return []
